"""A belt: a Wall that moves along itself, which is endless, so that its surface moves and the wall stays."""
import pytest
from yade import utils

from . import plane


@pytest.mark.parametrize("speed", [0.6, -0.6])
def test_what_is_put_on_a_belt(O, speed):
    """Until it has the belt's speed V a block is driven by mu g. So is a disk of I = m R^2/2 until it rolls, at V/3 after V/(3 mu g)."""
    mu, g, dt = 0.3, 9.81, 1e-3
    mat = plane.material(mu)
    O.bodies.append(utils.wall(0, axis=1, sense=1, material=mat))
    O.bodies[0].state.vel = (speed, 0, 0)
    block, disk = plane.disk((0, 0.1), 0.1, blocked="zXYZ", mat=mat), plane.disk((1, 0.1), 0.1, mat=mat)
    plane.engine(dt, gravity=(0, -g, 0))
    O.run(50, True)
    sign = speed / abs(speed)
    assert [O.bodies[i].state.vel[0] for i in (block, disk)] == pytest.approx([sign * mu * g * 50 * dt] * 2, rel=1e-5)
    assert O.bodies[disk].state.angVel[2] == pytest.approx(sign * 2 * mu * g * 50 * dt / 0.1, rel=1e-5)
    O.run(250, True)
    assert O.bodies[block].state.vel[0] == pytest.approx(speed, rel=1e-6)
    assert O.bodies[disk].state.vel[0] == pytest.approx(speed / 3, rel=1e-4) and O.bodies[disk].state.angVel[2] * 0.1 == pytest.approx(
        speed - O.bodies[disk].state.vel[0], rel=1e-4)
