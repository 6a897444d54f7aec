"""Draws the figures of a benchmark again: /usr/bin/python3 -m analysis.benchmark FOLDER"""
import sys

from . import draw

if len(sys.argv) != 2:
    sys.exit("usage: /usr/bin/python3 -m analysis.benchmark FOLDER, such as results/benchmark or analysis/published/benchmark")
try:
    print(*draw(sys.argv[1]), sep="\n")
except (OSError, ValueError) as error:
    sys.exit(f"analysis.benchmark: {error}; make the tables: make bench")
