"""What sweeps cost in a flow, where contacts open, close and slide from step to step."""
from cd_engine import core
from yade_scripts import run

TOLERANCE = 1e-3


def test_momentum_halves_the_sweeps(O, tmp_path):
    """Momentum that never pauses keeps errors of single contacts alive, and took more sweeps than none. In cycles it takes a third: of eight to
    twelve steps of a silo of 2000 disks, a hopper, a collapse and a filling 0.28 to 0.31."""
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
    assert 2 * sweeps["accelerated"] <= sweeps["nsgs"]
