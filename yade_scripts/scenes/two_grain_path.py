"""One disk is led around another along a closed path, without spins and slip: which force and energy remain in the tangential spring?

McNamara, Garcia-Rojo and Herrmann, Phys. Rev. E 77, 031304 (2008). The centres are d apart, the line between them has the angle theta.
Four legs of equal time: d shrinks by h = path_depth radius_mean; theta grows by A = path_angle; d and theta go back the same way.
The disks are then back at their places, and a spring whose force depends on positions alone has no force left. The table shows what YADE's laws
leave, with the stiffness k_t and R1 + R2 = 2R (n steps a leg, t the normal turned by +90 degrees):

    law                stretch d xi     force on the second disk     left of the force      work that the path takes
    standard           d dtheta         -k_t xi t                    k_t h A                k_t (h A)^2/2, what the spring holds then
    avoid_ratcheting   2R dtheta        -k_t xi t                    0                      -k_t 2R h A^2/2, gained from nothing
    path_independent   2R dtheta        -k_t xi (2R/d) t             0                      0

The first two laws also have an error of the time step: YADE turns the old shear force with the contact by a first-order rotation, which
lengthens it by dtheta^2/2 a step. It leaves -A^2/(2n) of the force at the far end of the path, and gains 2 A^2/(3n) of the energy there.

Springs of Contact Dynamics follow the standard law and turn the force exactly; a step stretches the spring by d sin(dtheta). A contact of two
immobile bodies has no force there, so the second disk is free and so heavy that it goes as it is led.
"""
import math

from yade_scripts import parameters
from yade_scripts.errors import ParameterError
from yade_scripts.scenes import Chart, Known, method

TITLE = "Closed path of two disks"
KIND = "closed paths"
HORIZON = "Whole paths, any number of them while nothing slips."
LEFT_OUT = "inertia and spins, since the motion of the disks is prescribed"
DEFAULTS = dict(disks=2, friction=2.0, beta_n=0.0, records_per_cycle=40, cd_contacts="springs")
CHART = Chart(physics=("stiffening", "beta_n"), rolling=True, exact={"left_force": 0.0, "loop_work": 0.0})

SOURCE = "McNamara et al. 2008, and the error of YADE's first-order rotation; see the file of the scene"

HOLD = 1.5  # Coulomb limit at the smallest overlap, over the largest force of the spring
HEAVY = 1e15  # mass of the led disk over that of its size, by Contact Dynamics
MOST = 0.5  # largest overlap over the smaller radius: at deeper ones disks of unequal size have no line of contact


def check(full):
    """Check that the disk can follow the path without slip, and that the contact has springs."""
    if full["method"] == "CD" and full["cd_contacts"] == "rigid":
        raise ParameterError("cd_contacts = rigid: rigid contacts store no force along a path; take springs")
    Path(full)


def build(full, folder):
    """Build two disks of radius_mean (1 -+ radius_spread); the second one is led `cycles` times around the path."""
    from yade import O, Vector3
    from yade_scripts.running import bodies, hooks, stage
    path = Path(full)
    ground, free = stage.Ground(full), full["method"] == "CD"
    disks = [ground.disk(place, radius=full["radius_mean"] * (1 + sign * full["radius_spread"]), blocked=blocked)
             for place, sign, blocked in (((0, 0), -1, "xyzXYZ"), (path.place(0, 0), 1, "zXYZ" if free else "xyzXYZ"))]
    scene = stage.scene(full, lightest=min(disk.state.mass for disk in disks))
    method(full).set_engines(full, scene)

    def carried():
        """Return the force on the second disk at the end of the last step: its contact's, whose normal is that of the step's start, turned."""
        n = disks[1].state.pos.normalized()
        if not O.interactions.has(0, 1, onlyReal=True):
            return parameters.stiffness(full) * path.overlap * n
        return bodies.normal_force(0, 1) * n + bodies.tangential_force(O.interactions[0, 1]) * Vector3(-n[1], n[0], 0)

    lead = Lead(O, path, scene.every * full["records_per_cycle"], full["cycles"], carried if free else lambda: O.forces.f(1, True))
    runner = hooks.runner(lead.step, iterPeriod=1, initRun=True)
    if free:  # before a step
        disks[1].state.mass *= HEAVY
        O.engines = [runner] + O.engines
    else:  # between the forces and the motion, so that the velocity at the next force is the one that has brought the disk there
        O.engines = O.engines[:-1] + [runner] + O.engines[-1:]
    force, work = path.left(lead.steps // 4)
    scene.known = [Known("left_force", "k_t R path_depth path_angle", force, scale=path.force_scale, source=SOURCE,
                         measure=lambda: bodies.tangential_force(O.interactions[0, 1]) / path.force_unit),
                   Known("loop_work", "k_t (2 R path_angle)^2/2", work, lambda: lead.done() / path.energy_unit, scale=1.0, source=SOURCE)]
    return scene


class Path:
    """The path in the plane, and what theory predicts for it. Raises ParameterError if the disk cannot follow it without slip."""

    def __init__(self, full):
        if full["friction"] == 0:
            raise ParameterError("friction = 0: the tangential spring of two_grain_path needs friction to hold it")
        if full["records_per_cycle"] % 4:
            raise ParameterError(f"records_per_cycle = {full['records_per_cycle']}: must be a multiple of 4 for the legs of two_grain_path")
        self.law, self.cycles = full["tangential_law"] if full["method"] == "MD" else "implicit", full["cycles"]
        self.angle, self.sum = full["path_angle"], 2 * full["radius_mean"]
        self.depth = full["path_depth"] * full["radius_mean"]
        stiffness = full["kt_over_kn"] * parameters.stiffness(full)
        self.force_unit = stiffness * self.depth * self.angle
        # The spring's largest force, in that unit: the force left is a small part of it.
        self.force_scale = self.sum / self.depth
        self.energy_unit = stiffness * (self.sum * self.angle)**2 / 2
        longest = self.angle * (self.sum + self.cycles * self.depth)
        self.overlap = HOLD * full["kt_over_kn"] * longest / full["friction"]
        if self.overlap + self.depth > MOST * full["radius_mean"] * (1 - full["radius_spread"]):
            raise ParameterError(f"path_angle = {self.angle}: so that nothing slips the disks would overlap by {self.overlap:.3g} m, too much of "
                                 "the smaller radius; take a smaller path_angle or kt_over_kn, or more friction")

    def place(self, leg, part):
        """Return the second disk's centre [m] when `part` of a leg (0 to 3) is done."""
        shallow = self.sum - self.overlap
        depth = self.depth * (part, 1, 1 - part, 0)[leg]
        theta = self.angle * (0, part, 1, 1 - part)[leg]
        return (shallow - depth) * math.cos(theta), (shallow - depth) * math.sin(theta)

    def left(self, steps):
        """Return the force and work, in the units of `build`, that the law leaves after `cycles` paths of `steps` steps a leg."""
        if self.law == "path_independent":
            return 0.0, 0.0
        share, turned = self.depth / self.sum, self.cycles * self.angle**2 / steps
        if self.law == "implicit":
            left = self.cycles * math.sin(self.angle / steps) * steps / self.angle
            return left, (left * share)**2
        if self.law == "avoid_ratcheting":
            return -turned / (2 * share), -self.cycles * share - 2 / 3 * turned * self._distance(1)
        return self.cycles - turned / (2 * share) * self._distance(1.5), (self.cycles * share)**2 - 2 / 3 * turned * self._distance(1)**2

    def _distance(self, depths):
        """Return d/(R1 + R2) at `depths` times the depth of the path; the value for each term comes from its expansion in h."""
        return 1 - (self.overlap + depths * self.depth) / self.sum


class Lead:
    """Leads the second disk along the path by setting its velocity, and sums up the work that this takes [J].

    The work of a step is the mean of the forces before and after it times its displacement, exact to second order in the step. The velocity
    points from the present place to the target, so that round-off does not add up.
    """

    def __init__(self, omega, path, steps, cycles, force):
        """omega: YADE's O. force: function that returns the force on the disk at the present place."""
        self.omega, self.path, self.steps, self.total, self.force = omega, path, steps, steps * cycles, force
        self.count, self.work, self.before = 0, 0.0, None

    def done(self):
        """Return the work up to the present place."""
        if self.before is None:
            return 0.0
        return self.work - 0.5 * (self.before + self.force()).dot(self.omega.bodies[1].state.vel) * self.omega.dt

    def step(self):
        """Set the velocity before the motion of a step; the forces are those at the present place."""
        self.work, self.before = self.done(), self.force()
        self.count += 1
        state, dt = self.omega.bodies[1].state, self.omega.dt
        leg, part = divmod((self.count - 1) % self.steps + 1, self.steps // 4)
        x, y = self.path.place(leg % 4, part / (self.steps // 4))
        state.vel = ((x - state.pos[0]) / dt, (y - state.pos[1]) / dt, 0) if self.count <= self.total else (0, 0, 0)
