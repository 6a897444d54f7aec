"""Figures of `make bench`, from the tables it writes: `/usr/bin/python3 -m analysis.benchmark results/benchmark` draws them again."""
from .draw import draw

__all__ = ["draw"]
