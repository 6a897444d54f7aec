"""Loads a prepared packing into YADE's console and sets the engines of a row, ready for O.run(); `make console` starts it.

    yade yade_scripts/console.py [name=value ...]      method=CD unless said otherwise
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(sys.argv[0]).resolve().parents[1]))

from yade_scripts import parameters, run

try:
    scene = run.start(**{"method": "CD"} | parameters.from_arguments(sys.argv[1:]))
except (parameters.ParameterError, ImportError) as error:
    sys.exit(f"console: {error}")

print("""
The packing is loaded and the engines are set: O.run(100, True) makes 100 steps; contact_dynamics.residual is the error of the last one.
scene = run.start(method="MD") starts again from the same packing with springs, run.start(friction=0.3) from another one.
run.execute(dict(method="CD", seed=2)) runs a whole row into a result file; all parameters: list(parameters.REGISTRY).""")
