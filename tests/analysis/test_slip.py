"""Slip from snapshot to snapshot: of disks that are moved by hand."""
import numpy as np
import pytest

from analysis import slip

R1, R2 = 0.01, 0.02


def pair(place=(0.03, 0.0), turns=(0.0, 0.0), tangential=0.0, **changed):
    """A snapshot of two disks in contact, the first at the origin."""
    normal = np.array(place) / np.linalg.norm(place)
    return dict(position=np.array([[0.0, 0.0], place]), angle=np.array(turns), body_ids=np.array([6, 7]), contact_ids=np.array([[6, 7]]),
                contact_point=R1 * normal[None], contact_normal=normal[None], contact_friction=np.array([0.1]), force_normal=np.array([2.0]),
                force_tangential=np.array([tangential])) | changed


@pytest.mark.parametrize("then, slipped", [
    (dict(), 0.0), (dict(place=(0.03, 1e-6)), 1e-6), (dict(turns=(1e-4, 0.0)), -1e-6), (dict(turns=(0.0, 1e-4)), -2e-6),
    (dict(turns=(2e-4, -1e-4)), 0.0)])  # they roll on each other
def test_rigid_disks_slip_by_what_their_surfaces_move(then, slipped):
    assert slip.between(pair(), pair(**then), np.inf) == {(6, 7): pytest.approx(slipped, abs=1e-10)}


def test_disks_that_turn_as_one_body_do_not_slip():
    angles = np.linspace(0, np.pi / 2, 501)
    snapshots = [pair(place=(0.03 * np.cos(a), 0.03 * np.sin(a)), turns=(a, a)) for a in angles]
    way = sum(slip.between(*both, np.inf)[6, 7] for both in zip(snapshots[:-1], snapshots[1:]))
    assert way == pytest.approx(0, abs=1e-5 * R1)  # second order in the steps


def test_a_stretched_spring_has_not_slipped():
    """The second disk moves up by 1 um, and the spring of 1e5 N/m pulls it back by 0.1 N; at 0.04 N the rest has slipped."""
    assert slip.between(pair(), pair(place=(0.03, 1e-6), tangential=-0.1), 1e5)[6, 7] == pytest.approx(0, abs=1e-10)
    assert slip.between(pair(), pair(place=(0.03, 1e-6), tangential=-0.04), 1e5)[6, 7] == pytest.approx(0.6e-6, abs=1e-10)


def test_contacts_without_friction_or_load_and_walls_do_not_count():
    for changed in (dict(contact_friction=np.array([0.0])), dict(force_normal=np.array([0.0])), dict(contact_ids=np.array([[3, 7]]))):
        assert slip.between(pair(**changed), pair(place=(0.03, 1e-6), **changed), np.inf) == {}
