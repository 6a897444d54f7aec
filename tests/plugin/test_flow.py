"""What sweeps cost in a flow, where contacts open, close and slide from step to step."""
from cd_engine import core
from yade_scripts import run

TOLERANCE = 1e-3


def test_momentum_needs_no_more_sweeps_than_plain_ones(O, tmp_path):
    """Momentum that never pauses keeps errors of single contacts alive, and took more sweeps than none. With pauses it takes half as many."""
    run.start(scene="hopper", disks=1000, seed=1)
    sweeps = {"accelerated": 0, "nsgs": 0}
    engine = next(e for e in O.engines if type(e).__name__ == "ContactDynamics")
    for step in range(200, 280, 10):
        O.run(step - O.iter, True)
        path = str(tmp_path / f"{step}.npz")
        engine.exportProblem(path, bodies=True)
        problem = core.read_problem(path)
        for method in sweeps:
            report = core.solve(problem, method, TOLERANCE, impulses=problem.impulses)
            assert report.converged
            sweeps[method] += report.iterations
    assert sweeps["accelerated"] <= sweeps["nsgs"]
