"""The box of the biaxial and the triaxial test: six walls around the sample, moved by a servo or pushed by forces (Hambly's principle, the paper's
Fig. 2).

Direction 1 is x, 2 is y (paper, section 2.1), and 3 is z, which only spheres load. Walls have thickness 0, so that a wall's position is its inner
face. Stresses [Pa] are positive in compression: a wall force over the wall's area (other side times depth).
"""
from yade import O, utils
from yade.wrapper import Sphere, TriaxialStressController

from yade_scripts.running import hooks
from yade_scripts.running.sums import total

X_LOW, X_HIGH, Y_LOW, Y_HIGH, Z_LOW, Z_HIGH = range(6)
# (axis, low wall, high wall)
DIRECTIONS = ((0, X_LOW, X_HIGH), (1, Y_LOW, Y_HIGH), (2, Z_LOW, Z_HIGH))


def in_space():
    """Return whether the grains are spheres that move in space, not disks; by the first one."""
    first = next(body for body in O.bodies if isinstance(body.shape, Sphere))
    return "z" not in first.state.blockedDOFs


def directions():
    """Return those of DIRECTIONS that are loaded: two for disks, three for spheres."""
    return DIRECTIONS if in_space() else DIRECTIONS[:2]


def append(sides, depth, material):
    """Append six fixed walls around (0, 0, -depth/2) .. (L_x, L_y, depth/2); sides [m]: (L_x, L_y). They must be the first bodies."""
    if len(O.bodies):
        raise ValueError("walls come first: their ids are 0 to 5")
    O.bodies.append(utils.aabbWalls([(0, 0, -depth / 2), (*sides, depth / 2)], thickness=0, material=material, color=(0.4, 0.4, 0.4)))


def faces():
    """Return the inner faces [m] of x-, x+, y-, y+ and, around spheres, z-, z+."""
    return [O.bodies[wall].state.pos[axis] for axis, low, high in directions() for wall in (low, high)]


def sides():
    """Return (L_x, L_y) [m] between the inner faces, and L_z around spheres."""
    places = faces()
    return tuple(high - low for low, high in zip(places[::2], places[1::2]))


def along_and_across(values):
    """Return the value of direction 2, and that of direction 1 or, of three values, the mean of directions 1 and 3."""
    one, two, *three = values
    return two, (one + three[0]) / 2 if three else one


def gamma(first):
    """Return strain2 - strain1 since the sides were `first`; around spheres strain1 is the mean of both directions across."""
    along, across = along_and_across([now / before for now, before in zip(sides(), first)])
    return along - across


def depth():
    """Return the depth of the sample [m]."""
    return O.bodies[Z_HIGH].state.pos[2] - O.bodies[Z_LOW].state.pos[2]


def areas():
    """Return the areas [m^2] on which sigma1 and sigma2 act, and that of sigma3 around spheres."""
    x, y, z = *sides()[:2], depth()
    return (y * z, x * z, x * y)[:len(directions())]


def stresses():
    """Return ((x-, x+), (y-, y+)), of spheres also (z-, z+): stress [Pa] on each loaded wall, from the normal forces of its contacts."""
    return tuple(tuple(abs(total(i.phys.normalForce[axis] for i in O.bodies[wall].intrs() if i.isReal)) / area for wall in (low, high))
                 for (axis, low, high), area in zip(directions(), areas()))


def mean_stresses():
    """Return (sigma1, sigma2) [Pa], of spheres also sigma3: means over opposite walls, whose stresses differ by the inertia of the disks."""
    return tuple(sum(pair) / 2 for pair in stresses())


def stress_error(p0):
    """Return the largest error of a loaded wall's stress against P0 [Pa], over P0."""
    return max(abs(stress / p0 - 1) for pair in stresses() for stress in pair)


def servo(goal, damping_ratio, mass, kn, max_velocity):
    """Return YADE's TriaxialStressController, which holds (sigma1, sigma2) = goal [Pa], in 2D around disks, with sigma3 around spheres.

    In each step it moves a wall by the stress error over the wall's stiffness. It does not know that dashpots of ratio beta act as a further
    stiffness of 2 beta tau/dt (tau = sqrt(m/k_n)), which raises its gain. Measured: at a gain of 2.1 the walls reverse their motion for ever at their
    largest velocity, without visible strain; up to 1.4 they are stable. stressDamping limits the gain to 1 here.
    """
    loop_gain = 2 * damping_ratio * (mass / kn)**0.5 / O.dt
    space, (length_x, length_y) = in_space(), sides()[:2]
    return TriaxialStressController(
        stressMask=7 if space else 3, goal1=-goal[0], goal2=-goal[1], goal3=-goal[2] if space else 0, internalCompaction=False, thickness=0,
        wall_front_activated=space, wall_back_activated=space, width0=length_x, height0=length_y, depth0=depth(),
        stressDamping=max(0.25, 1 - 1 / max(loop_gain, 1e-9)), max_vel=max_velocity,
        # YADE does not save the wall stiffness with the scene. Computed anew at every step, it is right after a reload, too.
        stiffnessUpdateInterval=1, computeStressStrainInterval=1)


def set_free(mass):
    """Let x+, y+ and, around spheres, z+ move along their normals with `mass` [kg]; the walls opposite stay."""
    for axis, _, wall in directions():
        state = O.bodies[wall].state
        state.mass = mass
        state.inertia = (mass, mass, mass)  # never used: rotations are blocked
        state.blockedDOFs = "xyzXYZ".replace("xyz"[axis], "")


class Load:
    """The load of PlateLoads as samples read it. With CD they stand at the end of a step, whose work PlateLoads sums at the beginning of the next."""

    @property
    def goal(self):
        """(sigma1, sigma2) [Pa] of the last step, at first those of the beginning."""
        engine = hooks.engine("PlateLoads")
        return tuple(-(engine.goal if engine.steps else engine.goals)[axis] for axis in (0, 1))

    def work(self):
        """Return the work so far [J], of the forces on the sample and the mass of the walls."""
        engine = hooks.engine("PlateLoads")
        # Of disks the last two of six plates, those before and behind the sample, have no load.
        now = total(force * (face - before) for force, face, before in zip(engine._pushes, faces(), engine._faces))
        return engine.work + now


class ServoLoad(Load):
    """Gives the goals to a TriaxialStressController. Its runner stands between PlateLoads and controller. The work is that on the sample."""

    def __init__(self, controller):
        self.controller = controller
        self._sum, self._positions, self._forces = 0.0, faces(), [0.0] * len(faces())

    def apply(self):
        """Apply the load of now, and add the work since the last call."""
        self.controller.goal1, self.controller.goal2 = (-goal for goal in self.goal)  # sigma3 stays as it is
        forces = self._now()
        self._sum += self._work(forces)
        self._positions, self._forces = faces(), forces

    def work(self):
        """Return the work so far [J]."""
        return self._sum + self._work(self._now())

    def _work(self, forces):
        """Return the work [J] since the last call of `apply`, by the trapezoidal rule; forces [N]: those of now."""
        moved = [now - before for now, before in zip(faces(), self._positions)]
        return total((before + now) / 2 * way for before, now, way in zip(self._forces, forces, moved))

    def _now(self):
        """Return the forces [N] of the walls on the disks."""
        return [-O.forces.f(wall)[axis] for axis, low, high in directions() for wall in (low, high)]
