"""Calls main(**settings) of a module of this folder inside YADE and prints what it returns as the last line, in JSON.

    yade -n -x -j 1 yade_scripts/measuring/in_yade.py worker '{"kind": "charts", "name": "stack", "full": false, "folder": "results"}'
"""
import importlib
import json
import pathlib
import sys

if __name__ == "__main__":
    sys.path.insert(0, str(pathlib.Path(sys.argv[0]).resolve().parents[2]))
    name, settings = sys.argv[1:]
    print(json.dumps(importlib.import_module(f"yade_scripts.measuring.{name}").main(**json.loads(settings))))
