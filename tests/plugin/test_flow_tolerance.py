"""The tolerance of a step: larger where bodies flow or collide than where they rest, unless a single one is asked for."""
import pytest

import cd_engine

from . import plane


def settings(O, **asked):
    return plane.engine(gravity=(0, -9.81, 0), **asked)


def tolerances(O, engine, steps):
    """The tolerances of so many steps, without repetitions."""
    found = []
    for _ in range(steps):
        O.run(1, True)
        found += [engine.stepTolerance] if not found or found[-1] != engine.stepTolerance else []
    return found


def test_a_heap_falls_and_comes_to_rest(O):
    """All tolerances occur, powers of ten between the two; at rest it is the smaller one, and every step has reached its own."""
    plane.heap(0.3)
    engine = settings(O)
    found = tolerances(O, engine, 1500)
    assert set(found) == {1e-4, 1e-5, 1e-6}
    assert engine.stepTolerance == engine.tolerance == 1e-6 and engine.unconvergedSteps == 0
    assert max(engine.residual, engine.bodyError) <= 1e-6


def test_for_means_flows_are_solved_to_a_larger_tolerance(O):
    """At rest as exactly as ever."""
    plane.heap(0.3)
    engine = settings(O, accuracy="means")
    assert (engine.tolerance, engine.flowTolerance) == (1e-6, 1e-3)
    found = tolerances(O, engine, 1500)
    assert set(found) == {1e-3, 1e-4, 1e-5, 1e-6}
    assert engine.stepTolerance == 1e-6 and engine.unconvergedSteps == 0


@pytest.mark.parametrize("given", [dict(stiffness=1e5, tangentialStiffness=5e4), dict(materialStiffness=True)])
def test_for_means_springs_are_solved_to_the_whole_motion_of_a_step(O, given):
    """The next step corrects it: at rest a column of three disks of 1 kg presses the floor as it weighs. 1e-6: what is left of the oscillation."""
    plane.columns(0)
    engine = plane.engine(gravity=(0, -9.81, 0), accuracy="means", dampingRatio=0.5, **given)
    assert engine.tolerance == 1 and cd_engine.engines(**given)[-1].tolerance == 0.1
    O.run(3000, True)
    assert O.interactions[0, 1].phys.normalForce[1] == pytest.approx(3 * 9.81, rel=1e-6) and engine.unconvergedSteps == 0


@pytest.mark.parametrize("asked, message", [
    (dict(accuracy="mean"), "must be one of 'bodies', 'means'"), (dict(accuracy=None), "must be one of 'bodies', 'means'"),
    (dict(tolerance=1e-5), "no meaning beside tolerance"), (dict(flowTolerance=1e-5), "no meaning beside flowTolerance"),
    (dict(fixedIterations=5), "no meaning beside fixedIterations")])
def test_an_accuracy_beside_what_contradicts_it_is_refused(O, asked, message):
    with pytest.raises(ValueError, match=message):
        cd_engine.engines(**{"accuracy": "means"} | asked)


def test_an_accuracy_for_single_bodies_is_the_default(O):
    for asked in ({}, {"accuracy": "bodies"}):
        engine = cd_engine.engines(**asked)[-1]
        assert (engine.tolerance, engine.flowTolerance) == (1e-6, 1e-4)
    assert cd_engine.engines(accuracy="bodies", tolerance=1e-5)[-1].tolerance == 1e-5


def test_a_heap_at_rest_is_solved_to_the_smaller_tolerance(O):
    """Errors within the larger tolerance move the disks, but not so much that this counts as a flow."""
    plane.heap(0.3)
    engine = settings(O, tolerance=1e-4, reduce=False)  # reduce would stop it
    O.run(1500, True)
    assert engine._unrest < 1e-4
    engine.tolerance = 1e-6
    engine.flowTolerance = 1e-4
    O.run(20, True)
    assert engine.stepTolerance == engine.tolerance


@pytest.mark.parametrize("speed, tolerance", [(1.0, 1e-4), (1e-5, 1e-4), (1e-6, 1e-5), (1e-7, 1e-6), (0, 1e-6)])
def test_how_fast_a_disk_slides(O, speed, tolerance):
    """A disk slides at constant speed v, driven against friction mu: p u/(W_nn |p|^2) = mu v/((1 + mu^2) g dt), and the tolerance is the
    largest power of ten not above it, within its limits."""
    mu, g, mass = 0.5, 9.81, 2.0
    plane.floor(plane.material(mu))
    disk = plane.disk((0, 0.01), 0.01, mass=mass, blocked="zXYZ", velocity=(speed, 0))
    O.forces.setPermF(disk, (mu * mass * g if speed else 0, 0, 0))
    engine = settings(O)
    O.run(3, True)
    assert engine._unrest == pytest.approx(mu * speed / ((1 + mu**2) * g * O.dt), rel=1e-9, abs=1e-12)
    assert engine.stepTolerance == pytest.approx(tolerance, rel=1e-12)


@pytest.mark.parametrize("margin", [0.1, 10])
def test_rest_is_judged_by_the_smaller_tolerance(O, margin):
    """A disk that only slides has to accelerate at 5e-7 g, of which an error within 1e-4 could keep it. Beside it disks fall into a box, so that
    these steps have the larger tolerance. When pairs are searched anew does not matter."""
    rough, mat = plane.material(1.0), plane.material(0.5)
    plane.floor(rough)
    slides = plane.disk((0, 0.01), 0.01, mass=1.0, blocked="zXYZ", mat=mat)
    for x in 0.62, 0.7:
        plane.box((x, 0.2), (0.02, 0.2), mat=rough)
    for k in range(3):
        plane.disk((0.668, 0.02 + 0.1 * k), 0.01, mass=1.0, mat=rough)
    engine = settings(O, searchMargin=margin)
    O.run(100, True)
    for excess in -1e-7, 5e-7:
        engine.gravity = ((0.5 + excess) * 9.81, -9.81, 0)
        O.run(100 if excess < 0 else 2000, True)
    assert O.bodies[slides].state.vel[0] == pytest.approx(5e-7 * 9.81 * 2.0, rel=1e-3)


def test_what_sleeps_does_not_count(O):
    """A heavy disk rests far away. Once it sleeps, the ratio is that of the sliding disk alone."""
    mu, g, speed = 0.5, 9.81, 1e-5
    plane.floor(plane.material(mu))
    plane.disk((1, 0.01), 0.01, mass=1e4)
    sliding = plane.disk((0, 0.01), 0.01, mass=2.0, blocked="zXYZ", velocity=(speed, 0))
    O.forces.setPermF(sliding, (mu * 2.0 * g, 0, 0))
    engine = settings(O)
    O.run(100, True)
    assert engine.sleeping == 1 and engine.islands == 2
    assert engine._unrest == pytest.approx(mu * speed / ((1 + mu**2) * g * O.dt), rel=1e-6)


def test_the_tolerance_falls_only_after_some_steps_at_rest(O):
    """The ratio fades by a tenth a step: from a stop at ratio 0.4 it takes 79 steps to 1e-4, 22 more to 1e-5, and the test follows it to 1e-6."""
    plane.floor(plane.material(0.5))
    disk = plane.disk((0, 0.01), 0.01, mass=2.0, blocked="zXYZ", velocity=(0.01, 0))
    O.forces.setPermF(disk, (0.5 * 2.0 * 9.81, 0, 0))
    engine = settings(O, reduce=False)
    O.run(3, True)
    at_stop = engine._unrest
    O.forces.setPermF(disk, (0, 0, 0))
    O.bodies[disk].state.vel = (0, 0, 0)
    for steps in 60, 30, 30, 30:
        O.run(steps, True)
        faded = at_stop * 0.9**(O.iter - 3)
        assert engine._unrest == pytest.approx(faded, rel=1e-9)
    assert faded < 1e-6 and engine.stepTolerance == 1e-6


@pytest.mark.parametrize("set_by", ["engines", "assignment", "updateAttrs", "fixedIterations"])
def test_a_tolerance_that_is_asked_for_holds_in_every_step(O, set_by):
    plane.heap(0.3)
    if set_by == "assignment":
        engine = settings(O)
        engine.tolerance = 1e-5
    elif set_by == "updateAttrs":
        engine = settings(O)
        engine.updateAttrs({"tolerance": 1e-5})
    else:
        engine = settings(O, tolerance=1e-5, fixedIterations=20 if set_by == "fixedIterations" else 0)
    assert engine.flowTolerance == 0
    assert tolerances(O, engine, 200) == [1e-5]


def test_both_tolerances_in_either_order(O):
    for names in ("tolerance", "flowTolerance"), ("flowTolerance", "tolerance"):
        engine = cd_engine.ContactDynamics(**{name: {"tolerance": 1e-7, "flowTolerance": 1e-3}[name] for name in names})
        assert (engine.tolerance, engine.flowTolerance) == (1e-7, 1e-3)


def test_the_tolerance_falls_while_all_sleep(O):
    """Steps that are skipped, since nothing can change, count like those that are made."""
    def after(publish):
        O.reset()
        plane.floor(plane.material(0.5))
        for x in 0, 0.05:
            plane.disk((x, 0.0101), 0.01)
        engine = settings(O, publish=publish)
        O.run(60, True)
        assert engine.sleeping == engine.islands == 2 and engine._unrest > 1e-4
        found = []
        for _ in range(10):
            O.run(10, True)
            found += [(engine._unrest, engine.stepTolerance)]
        return found

    assert after("due") == after("always") and after("due")[-1][0] < 1e-6 == after("due")[-1][1]


def test_the_ways_to_make_a_step_choose_the_same_tolerance(O, tmp_path):
    """publish, reduce, threads and a saved scene: the same bits."""
    def after(saved=False, **asked):
        O.reset()
        plane.heap(0.3)
        engine = settings(O, **asked)
        O.run(150, True)
        if saved:
            O.save(str(tmp_path / "scene.yade"))
            O.reset()
            O.load(str(tmp_path / "scene.yade"))
            engine = O.engines[-1]
        O.run(150, True)
        return plane.digest(), engine.stepTolerance

    one = after()
    assert all(after(**way) == one for way in (dict(publish="always"), dict(threads=2), dict(saved=True)))
