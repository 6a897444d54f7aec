"""Loads a prepared packing into YADE's console and sets the engines of a row, ready for O.run(). `make console` starts it.

    yade yade_scripts/console.py [name=value ...]      the method is CD unless method=MD is given
"""
import pathlib
import sys

file = sys._getframe().f_code.co_filename  # YADE sets no __file__
if locals() is not globals():
    sys.exit(f"write execfile({file!r}, globals()): without globals() the functions of a script do not find its names")
sys.path.insert(0, str(pathlib.Path(file).resolve().parents[1]))

import cd_engine
from yade import plot
from yade_scripts import commands, parameters, run, tables
from yade_scripts.errors import ParameterError

__all__ = ["cd_engine", "parameters", "plot", "row", "run", "scene", "start"]  # names for the user of the console
row, scene = {"method": "CD"}, None


def start(**changes):
    """Start again with `changes` to the current row; other parameters keep their values, also the method. Return the scenes.Scene.

    Another scene keeps those that it knows. A mistake is printed, and all stays as it is; if it is found late, the former scene is built anew.
    """
    global row, scene
    begun = False
    try:
        name = parameters.REGISTRY["scene"]
        known = parameters.registry(name.check(changes.get("scene", row.get("scene", name.default))))
        changed = {name: value for name, value in row.items() if name in known} | changes
        parameters.complete(changed)
        begun = True
        scene = run.start(**changed)
        row = changed
    except (ParameterError, ImportError, OSError, RuntimeError, ValueError) as error:
        print(f"console: {error}", file=sys.stderr)
        if begun and scene is not None:
            scene = run.start(**row)
    return scene


try:
    first = tables.given(sys.argv[1:] if commands.started(file) else [])
except ParameterError as error:
    print(f"console: {error}", file=sys.stderr)
    first = None
if first is None or start(**first) is None:
    sys.exit(commands.MISTAKE)

print("""
The packing is loaded and the engines are set: O.run(100, True) makes 100 steps; contact_dynamics.summary() shows how they went.
scene = start(friction=0.3) starts again from another packing, start(method="MD") with springs; earlier settings are kept.
run.execute(dict(method="CD", seed=2)) makes a whole run and its result file; start() then loads the packing again.
O.run(scene.every * scene.samples, True) runs a scene to its end, and [(k.name, k.measure(), k.exact) for k in scene.known] then compares it with
what is known. All parameters: print(parameters.listing()).
cd_engine and plot are imported: help(cd_engine.ContactDynamics) shows every setting and result.""")
