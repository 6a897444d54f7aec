"""Map of CD in space: tolerance against the number of spheres in a tube."""
from yade_scripts.measuring.maps import Axis, INACCURATE, Map, NOT_SOLVED, TOLERANCES, UNSTABLE, judged, lines, logarithmic, product, whole

STEPS, DT = 200, 1e-3
WIDTHS = {True: [2.2, 3.0], False: [3.0]}  # inner width of the tube over the radius, of the full and of the quick map

MAP = Map(
    order=20,
    title="Spheres in space: the tolerance in a tube",
    question="How many spheres may stand in a tube at a given tolerance until its walls carry wrong forces?",
    criterion="Spheres stand on each other in opposite corners of a square tube without friction (scene tube), 200 steps of 1 ms from rest "
              "without forces, at most 20000 sweeps. Not solved: steps missed the tolerance. Unstable: bodies overlap by more than 1 % of the "
              "radius. Inaccurate: a force on a wall or on the floor is off by more than 1 % of its exact value.",
    remedy="The errors of all spheres add up and the column sinks: below a tolerance of 1e-4 a force was off by up to {{ (cells.force_error "
           "/ cells.tolerance)[cells.tolerance < 1e-4].max() | sci }} tolerances, with {{ cells.disks.max() }} spheres; above it, by all of "
           "it. All steps count as solved: repeat a run with a hundredth of the tolerance.",
    x=Axis("tolerance", "tolerance"), y=Axis("disks", "spheres in the tube"), panels="tube_width",
    measures={"force_error": "largest error of a force on a wall or on the floor, relative to its exact value",
              "penetration": "largest overlap over the radius", "unconverged": "share of the steps that missed the tolerance"},
    grid=lambda full: product(tube_width=WIDTHS[full], disks=whole(logarithmic(2, 200, 8 if full else 4)),
                              tolerance=logarithmic(1e-10, 1e-1, 10 if full else 4)),
    searches=lambda full: lines("tolerance", 1e-10, 1.0, 1.05 if full else 1.3, tube_width=WIDTHS[full],
                                disks=whole(logarithmic(2, 200, 8 if full else 4))),
    marks=TOLERANCES)


def probe(case):
    from yade_scripts.measuring import space_cases
    run = space_cases.Case("tube", STEPS, DT, max_iterations=20000, **case)
    run.run()
    measures = {"force_error": max(map(run.error, ("worst_force_error", "on_the_floor"))),
                "penetration": run.engine.deepestPenetration / run.full["radius_mean"], "unconverged": run.unconverged}
    return judged(measures, run.told, (NOT_SOLVED, "non-convergence", run.unconverged > 0),
                  (UNSTABLE, "penetration", measures["penetration"] > 0.01), (INACCURATE, "wrong forces", measures["force_error"] > 0.01))
