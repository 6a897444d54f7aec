"""What the probes of Contact Dynamics in space share: scenes of the collection, run with a row of their parameters, and places for spheres."""
from yade import O

from yade_scripts import parameters, results, scenes
from yade_scripts.measuring import rigid
from yade_scripts.running import bodies, hooks, stage


class Case:
    """A scene that is built in O. full: {name: value} of all parameters; engine: ContactDynamics; spheres: bodies, from the first; dt: step [s]."""

    def __init__(self, scene, steps, dt, **row):
        """Build a scene that lasts for `steps` steps, a multiple of ten, of `dt` [s]."""
        self.steps, self.dt = steps, dt
        self.full = parameters.complete({"scene": scene, "method": "CD", "cd_dt": dt, "period": steps * dt, "records_per_cycle": 10} | row)
        self.known = {known.name: known for known in scenes.build(self.full, results.FOLDER).known}
        self.engine, self.spheres = O.engines[-1], bodies.disks()
        self.sphere, self.floor = self.spheres[0], self.spheres[0].id - 1

    def run(self):
        hooks.simulate(self.steps)

    def error(self, name):
        """Return by how much a known quantity of the scene is off now, over its scale."""
        known = self.known[name]
        return abs(known.measure() - known.exact) / known.scale

    def energy(self):
        """Return the kinetic energy of the first sphere [J]."""
        state = self.sphere.state
        return (state.mass * state.vel.squaredNorm() + state.inertia[0] * state.angVel.squaredNorm()) / 2

    @property
    def unconverged(self):
        """The share of the steps that missed the tolerance."""
        return self.engine.unconvergedSteps / self.steps

    @property
    def told(self):
        return rigid.told(self.engine, self.full["radius_mean"])


def ground(radius, mu):
    """Return where spheres of this radius [m] and friction are placed."""
    return stage.Ground(parameters.complete({"scene": "mesh_floor", "radius_mean": radius, "friction": mu}))


def heavier(body, ratio):
    """Multiply the mass and the inertia of a body by `ratio`. Return its id."""
    body.state.mass *= ratio
    body.state.inertia *= ratio
    return body.id


def normal(*pair):
    """Return a function that returns the normal force between two bodies [N]."""
    return lambda: bodies.normal_force(*pair)


def tangential(*pair):
    """Return a function that returns the size of the friction between two bodies [N], 0 without contact."""
    return lambda: O.interactions[pair].phys.shearForce.norm() if O.interactions.has(*pair, onlyReal=True) else 0.0
