"""Calls main(**settings) of a module of this folder inside YADE and prints what it returns as the last line, in JSON.

    yade -n -x -j 1 yade_scripts/measuring/in_yade.py worker '{"kind": "charts", "name": "stack", "full": false, "folder": "results"}'
"""
import importlib
import json
import pathlib
import sys

if __name__ == "__main__":
    file = sys._getframe().f_code.co_filename  # YADE sets no __file__
    sys.path.insert(0, str(pathlib.Path(file).resolve().parents[2]))
    from yade_scripts import commands
    if not commands.started(file) or len(sys.argv) != 3:
        sys.exit("in_yade.py: needs a module and its settings; python3 -m yade_scripts.measuring starts it with them")
    name, settings = sys.argv[1:]
    print(json.dumps(importlib.import_module(f"yade_scripts.measuring.{name}").main(**json.loads(settings))))
