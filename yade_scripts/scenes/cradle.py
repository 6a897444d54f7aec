"""Equal disks stand in a row with small gaps between them; the first one hits the row (Newton's cradle).

Because of the gaps every collision involves only two disks. A disk of speed v that hits one at rest leaves them with the speeds
(1 - e)/2 v and (1 + e)/2 v (momentum, Newton's restitution).
  e = 1  the whole speed is passed on: the last disk leaves with it, the others rest.
  e = 0  colliding disks move on together: in the end all move at v/n.
  else   the last of n leaves at ((1 + e)/2)^(n-1) v. The disks behind it are at most as fast as the first, (1 - e)/2 v, since a collision
         with a slower one does not speed up a faster one; if that is less, nothing catches up with the last.
"""
from yade_scripts import parameters
from yade_scripts.errors import ParameterError
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart, Known
from yade_scripts.running.sums import total

TITLE = "Newton's cradle: momentum through a row of disks"
KIND = "impacts"
HORIZON = "From the last collision on, for any time; MD only while a collision, pi sqrt(m/2k_n) long, is over before the next disk is met."
LEFT_OUT = "the strings; and disks that touch, whose speeds Newton's law does not determine, while springs would give a wave"
DEFAULTS = dict(method="CD", disks=5, radius_spread=0.0, friction=0.0, restitution=1.0, beta_n=0.0, speed=0.1, period=0.1, records_per_cycle=10,
                tolerance=1e-13)
PARAMETERS = (Parameter("gap", 0.05, "1", "distance between neighbouring disks, over the mean radius", low=1e-6, high=100),)
CHART = Chart(physics=("beta_n",))

MOMENTUM = "conservation of momentum"


def last_speed(full):
    """Return the speed of the last disk over `speed`; None if others may catch up with it."""
    e, others = parameters.restitution(full), full["disks"] - 1
    if e == 0:
        return 1 / full["disks"]
    speed = ((1 + e) / 2)**others
    return speed if (1 - e) / 2 < speed else None


def check(full):
    """Check that all collisions happen in time, and that no disk can catch up with the last."""
    way = full["disks"] * full["gap"] * full["radius_mean"]
    slowest = min(1, ((1 + parameters.restitution(full)) / 2)**(full["disks"] - 1)) * full["speed"]
    if way >= slowest * full["period"] * full["cycles"]:
        raise ParameterError(f"period = {full['period']}: the disks of the cradle need up to {way / slowest:.3g} s to reach each other")
    if full["disks"] < 2 or last_speed(full) is None:
        raise ParameterError(f"disks = {full['disks']}: must be at least 2, and so few that none catches up with the last, "
                             "(1 - e)/2 < ((1 + e)/2)^(disks - 1), or e = 0")


def build(full, folder):
    """Build the row along x; the first disk starts a gap before the second."""
    from yade_scripts.running import stage
    ground = stage.Ground(full)
    speed, count, e = full["speed"], full["disks"], parameters.restitution(full)
    row = [ground.disk((k * (2 + full["gap"]) * ground.radius, 0), velocity=(speed if k == 0 else 0, 0)) for k in range(count)]

    def speeds():
        return [disk.state.vel[0] / speed for disk in row]

    known = [Known("last_speed", "speed", last_speed(full), lambda: speeds()[-1], scale=1.0, source="binary collisions, one after the other"),
             Known("momentum", "m speed", 1.0, lambda: total(speeds()), source=MOMENTUM)]
    if e in (0, 1):
        left = e == 0 and 1 / count
        known.append(Known("fastest_deviation", "speed", 0.0, lambda: max(abs(v - left) for v in speeds()[:-1]), scale=1.0,
                           source="e = 1: all but the last at rest; e = 0: all at 1/n"))
    return stage.small(full, known)
