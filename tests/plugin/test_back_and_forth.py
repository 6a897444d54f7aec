"""Springs and rigid contacts take over from each other again and again, each with the same list of engines."""
import math
import time

from yade import wrapper as w

import cd_engine
from yade_scripts.running.hooks import runner

from . import plane

RADIUS = 0.01


def box_of_disks(O):
    """Sixty disks at rest in a box, by springs that stay soft enough to overlap visibly. Return the two lists of engines and both time steps."""
    mat = plane.material(0.3)
    for centre, half in (((0.1, -0.05), (0.3, 0.05)), ((-0.05, 0.2), (0.05, 0.3)), ((0.21, 0.2), (0.05, 0.3))):
        plane.box(centre, half, mat=mat)
    plane.grid(60, 7, (0.011, 0.011), (0.0215, 0.021), mat, mass=0.05)
    springs = plane.springs(damping=0.5)
    rigid = cd_engine.engines(gravity=(0, -9.81, 0), tolerance=1e-8)
    slow, fast = 1e-3, 0.2 * math.sqrt(0.05 / 1e4)
    O.engines, O.dt = springs, fast
    O.run(4000, True)
    return springs, rigid, fast, slow


def deepest(O, found_only):
    """Deepest overlap of two disks [m]; found_only: of pairs that have an interaction."""
    disks = [b for b in O.bodies if isinstance(b.shape, w.Sphere)]
    return max(2 * RADIUS - (one.state.pos - other.state.pos).norm() for k, one in enumerate(disks) for other in disks[:k]
               if not found_only or O.interactions.has(one.id, other.id, True))


def test_a_collider_used_before_finds_what_came_together_meanwhile(O):
    """The springs' collider notices only bounds that begin to overlap, so that it has to begin anew: else disks sink into each other."""
    springs, rigid, fast, slow = box_of_disks(O)
    at_rest = deepest(O, False)
    for tilt in (3, -3):
        O.engines, O.dt = rigid, slow
        rigid[-1].gravity = (tilt, -9.81, 0)
        O.run(300, True)
        cd_engine.release()
        O.engines, O.dt = springs, fast
        O.run(3000, True)
        assert deepest(O, True) == deepest(O, False) < 1.5 * at_rest


def test_nothing_moves_at_any_handover(O):
    """Not only at the first one: overlaps that springs have left count as touching each time, those of the time before no longer."""
    springs, rigid, fast, slow = box_of_disks(O)
    for weight in (9.81, 4, 9.81):
        springs[-1].gravity = rigid[-1].gravity = (0, -weight, 0)
        O.run(4000, True)
        overlap, places = deepest(O, False), [b.state.pos for b in O.bodies]
        O.engines, O.dt = rigid, slow
        O.run(50, True)
        # What springs have not settled moves on; an overlap pushed out would be as large as the overlaps, a contact lost even larger.
        assert max((b.state.pos - place).norm() for b, place in zip(O.bodies, places)) < 0.05 * overlap
        assert overlap < rigid[-1].handoverOverlap < 1.5 * overlap and rigid[-1].maxPenetration < 0.05 * overlap
        cd_engine.release()
        O.engines, O.dt = springs, fast


def test_a_loaded_engine_takes_over_what_springs_leave(O, tmp_path):
    """Also one that had no overlap to take over before it was saved."""
    plane.grid(5, 1, (0, 1.05 * RADIUS), (0, 2.05 * RADIUS), plane.ground(), mass=0.05, blocked="xzXYZ")
    plane.run(400, 1e-3, gravity=(0, -9.81, 0))
    O.save(str(tmp_path / "rigid.yade"))
    O.load(str(tmp_path / "rigid.yade"))
    rigid = list(O.engines)
    assert 0 < rigid[-1].handoverOverlap < 1e-12
    cd_engine.release()
    O.engines, O.dt = plane.springs(damping=0.5), 0.2 * math.sqrt(0.05 / 1e4)
    O.run(5000, True)
    overlap = deepest(O, False)
    O.engines, O.dt = rigid, 1e-3
    O.run(50, True)
    assert overlap < rigid[-1].handoverOverlap < 1.5 * overlap and rigid[-1].maxPenetration < 0.05 * overlap


def test_springs_of_another_scene_hand_nothing_over(O, tmp_path, capfd):
    """What a loaded scene has as an overlap that came by itself is told, whatever ran before in the same YADE."""
    plane.grid(5, 1, (0, 1.05 * RADIUS), (0, 2.05 * RADIUS), plane.ground(), mass=0.05, blocked="xzXYZ")
    plane.run(400, 1e-3, gravity=(0, -9.81, 0))
    O.save(str(tmp_path / "rigid.yade"))
    cd_engine.release()
    O.engines, O.dt = plane.springs(damping=0.5), 0.2 * math.sqrt(0.05 / 1e4)
    O.run(10, True)
    O.load(str(tmp_path / "rigid.yade"))
    disk = O.bodies[len(O.bodies) - 1]
    disk.state.pos = disk.state.pos - (0, 0.3 * RADIUS, 0)
    O.run(2, True)
    assert O.engines[-1].deepestPenetration > 0.2 * RADIUS and "overlap by" in capfd.readouterr().err


def test_no_release_in_the_middle_of_a_run(O):
    """The takeover is prepared where a run begins, so an engine of the run is refused."""
    _, rigid, _, slow = box_of_disks(O)
    said = []

    def from_an_engine():
        try:
            cd_engine.release()
        except RuntimeError as error:
            said.append(str(error))

    O.engines, O.dt = rigid + [runner(from_an_engine, iterPeriod=1)], slow
    O.run(2, True)
    assert len(said) == 2 and "a run goes on" in said[0]
    cd_engine.release()


def test_a_paused_run_has_ended_its_last_step(O):
    """release() erases what such a step would still use."""
    _, rigid, _, slow = box_of_disks(O)
    O.engines, O.dt = rigid, slow
    for k in range(40):
        O.run(10**9)
        stop = O.stopAtIter
        time.sleep(1e-3 * (k % 5))
        O.pause()
        assert O.stopAtIter == stop
        cd_engine.release()


def test_a_pause_near_the_end_of_a_run_changes_no_end(O):
    """The run neither goes beyond its own stop, nor does a stop remain that is not its own."""
    _, rigid, _, slow = box_of_disks(O)
    O.engines, O.dt = rigid, slow
    for k in range(60):
        begin, count = O.iter, 5 + 3 * (k % 10)
        O.run(count)
        time.sleep(3e-4 * (k % 7))
        O.pause()
        stop = O.stopAtIter
        while O.running:
            time.sleep(1e-3)
        time.sleep(5e-3)  # the last step may still run
        assert O.iter <= begin + count
        assert stop == begin + count if O.iter < begin + count else stop <= O.iter


def test_who_wants_no_handover_gets_none(O):
    springs, _, fast, slow = box_of_disks(O)
    rigid = cd_engine.engines(gravity=(0, -9.81, 0), handover=False)
    for _ in range(2):
        O.engines, O.dt = rigid, slow
        O.run(2, True)
        assert rigid[-1].handoverOverlap == 0
        cd_engine.release()
        O.engines, O.dt = springs, fast
        O.run(100, True)
