"""Sets the time step, the engines of the row's method and the loaded walls, once the bodies of a scene exist."""
import math

from yade import O

from yade_scripts import parameters
from yade_scripts.preparing import bodies
from yade_scripts.running import md_step, walls
from yade_scripts.scenes import Scene, method


def set_step(full, largest):
    """Set O.dt <= largest [s] so that samples fall on whole steps. Return the number of steps between two samples."""
    every, O.dt = parameters.steps(full, largest)
    return every


def largest_step(full):
    """Return the largest step [s] of the row's method for the bodies in O."""
    if full["method"] == "CD":
        return full["cd_dt"]
    lightest = min(b.state.mass for b in O.bodies if b.state.blockedDOFs != "xyzXYZ")
    return full["md_dt_factor"] * math.sqrt(lightest / parameters.stiffness(full))


def load_walls(full, scene, goals):
    """Set O.engines of the row's method for a scene in the biaxial box, whose walls are loaded by goals(t) -> (sigma1, sigma2) [Pa].

    Walls x+ and y+ become free unless a servo moves them.
    """
    if full["method"] == "CD" or full["md_walls"] == "force":
        walls.set_free(full["wall_mass_ratio"] * bodies.mean_mass())
    if full["method"] == "MD":
        md_step.check(full)
    method(full).set_engines(full, scene, goals)


def small(full, known):
    """Set step and engines for the bodies just placed, and return their Scene, which has no loaded walls. known: its list of Known."""
    scene = Scene(every=set_step(full, largest_step(full)), samples=full["records_per_cycle"] * full["cycles"], known=known)
    method(full).set_engines(full, scene)
    return scene
