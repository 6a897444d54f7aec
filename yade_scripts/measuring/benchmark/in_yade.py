"""Calls main(**settings) of a module of this folder inside YADE and prints what it returns as the last line, in JSON.

    yade -n -x yade_scripts/measuring/benchmark/in_yade.py step '{"rows": 20, "columns": 2000, "tolerance": 1e-4, "steps": 100, "order": "built"}'
"""
import importlib
import json
import pathlib
import sys

if __name__ == "__main__":
    sys.path.insert(0, str(pathlib.Path(sys.argv[0]).resolve().parents[3]))
    name, settings = sys.argv[1:]
    print(json.dumps(importlib.import_module(f"yade_scripts.measuring.benchmark.{name}").main(**json.loads(settings))))
