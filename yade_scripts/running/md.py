"""Molecular Dynamics: YADE's Cundall-Strack engines with the paper's contact law.

Normal: eq. 5, R = k_n delta - gamma d(delta)/dt, not clipped (a parting contact may pull), gamma = 2 beta_n sqrt(k_n m_eff).
Tangential: eq. 6 and the Coulomb condition; eq. 6's dashpot, which YADE's viscous law does not have, if tangential_damping is not 0
(cd_engine.TangentialDashpots). Three laws between disks:
    standard           Cundall-Strack in YADE: the stretch takes the relative velocity at the contact point, arms R_i - delta/2
    avoid_ratcheting   YADE's avoidGranularRatcheting: arms R_i and (R1 + R2)/d in the stretch, forces and torques as before
    path_independent   McNamara et al. 2008: the stretch as an exact differential, and its forces (cd_engine.PathIndependentShear)
Against walls it is always the standard one.
"""
import math

from yade import O
from yade.wrapper import (Bo1_Box_Aabb, Bo1_Facet_Aabb, Bo1_Sphere_Aabb, Bo1_Wall_Aabb, ForceResetter, Ig2_Box_Sphere_ScGeom,
                          Ig2_Facet_Sphere_ScGeom, Ig2_Sphere_Sphere_ScGeom, Ig2_Wall_Sphere_ScGeom, InsertionSortCollider, InteractionLoop,
                          Ip2_FrictViscoMat_FrictViscoMat_FrictViscoPhys, Law2_ScGeom_FrictViscoPhys_CundallStrackVisco, MatchMaker,
                          NewtonIntegrator)

import cd_engine
from yade_scripts import parameters
from yade_scripts.running import bodies, hooks, walls


def contact_engines(full, tangential_law="standard"):
    """Return the engines up to the contact forces; all contacts, also those with walls, have the same stiffness. Packings are prepared with the
    standard law."""
    kn, ratio = (MatchMaker(algo="val", val=value) for value in (parameters.stiffness(full), full["kt_over_kn"]))
    engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Box_Aabb(), Bo1_Wall_Aabb(), Bo1_Facet_Aabb()]),
        InteractionLoop([Ig2_Sphere_Sphere_ScGeom(avoidGranularRatcheting=tangential_law == "avoid_ratcheting"), Ig2_Box_Sphere_ScGeom(),
                         Ig2_Wall_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom()],
                        [Ip2_FrictViscoMat_FrictViscoMat_FrictViscoPhys(kn=kn, kRatio=ratio)],
                        [Law2_ScGeom_FrictViscoPhys_CundallStrackVisco()])]
    if tangential_law == "path_independent":
        engines.append(cd_engine.PathIndependentShear())
    return engines


def integrator(full, damping=0.0):
    """Return the engine of Newton's equations; damping is YADE's force reduction, for preparations only."""
    return NewtonIntegrator(damping=damping, gravity=(0, -full["gravity"], 0))


def set_friction(disks, wall):
    """Give disks and walls their coefficients of friction, in the materials and in the contacts that exist; YADE takes the smaller of two."""
    for label, mu in (("disk", disks), ("wall", wall)):
        O.materials[label].frictionAngle = math.atan(mu)
    for contact in bodies.contacts():
        contact.phys.tangensOfFrictionAngle = min(math.tan(O.bodies[k].mat.frictionAngle) for k in (contact.id1, contact.id2))


def damping(full):
    """Return the damping ratio beta_n of the contacts while they are loaded."""
    return parameters.damping(full)


def set_damping(ratio):
    """Give the materials, and the contacts that exist, this damping ratio beta_n."""
    for material in O.materials:
        material.betan = ratio
    for contact in bodies.contacts():
        contact.phys.cn = ratio * contact.phys.cn_crit


def stiffen(factor):
    """Multiply the stiffnesses of the contacts that exist; their dashpots keep the damping ratio."""
    for contact in bodies.contacts():
        contact.phys.kn *= factor
        contact.phys.ks *= factor
        contact.phys.cn *= math.sqrt(factor)
        contact.phys.cn_crit *= math.sqrt(factor)


def set_engines(full, scene, load=None):
    """Set O.engines for a scene, its walls loaded by PlateLoads of these settings or not at all.

    Samples are taken after the forces (with the loads) and before the motion, when positions and forces belong to the same time.
    """
    observer = hooks.runner(lambda: scene.observer(), iterPeriod=scene.every, initRun=True, label=hooks.SAMPLING)
    if load is None:
        loading = [observer]
    elif full["md_walls"] == "servo":
        goal = [-goal for goal in load["goals"]]
        controller = walls.servo(goal, damping(full), bodies.mean_mass(), parameters.stiffness(full), max_velocity=1.0)
        scene.load = walls.ServoLoad(controller)
        # A divisor, so that the work of the walls is up to date at every sample.
        every = max(n for n in range(1, full["md_load_every"] + 1) if scene.every % n == 0)
        loading = [cd_engine.PlateLoads(**load), hooks.runner(scene.load.apply, iterPeriod=every, initRun=True), observer, controller]
    else:
        scene.load = walls.Load()
        loading = [cd_engine.PlateLoads(**load), observer]
    engines = contact_engines(full, full["tangential_law"])
    if full["tangential_damping"]:
        engines.append(cd_engine.TangentialDashpots(ratio=full["tangential_damping"]))
    engines += [cd_engine.DashpotWork(label=hooks.SUMMING)] * full["md_energies"]
    O.engines = engines + loading + [integrator(full)]
    bind(full, scene)


def law():
    """Return the law functor in O. Its plasticDissipation(), the energy that friction has dissipated [J], is not stored by O.save."""
    return hooks.engine("InteractionLoop").lawDispatcher.functors[0]


def friction_dissipation(full, boxed):
    """Return the energy dissipated by friction [J]; NaN if disks slip by PathIndependentShear but walls by the functor.

    boxed: whether the sample is in the biaxial box.
    """
    if full["tangential_law"] != "path_independent":
        return law().plasticDissipation()
    # PathIndependentShear does not see contacts with walls.
    return hooks.engine("PathIndependentShear").frictionDissipation if boxed and not full["wall_friction"] else math.nan


def bind(full, scene):
    """Have the law functor in O sum the dissipation, and give the scene the controller in O; after O.load both are other objects."""
    law().traceEnergy = full["md_energies"]
    if isinstance(scene.load, walls.ServoLoad):
        scene.load.controller = hooks.engine("TriaxialStressController")


def run(scene, simulate=hooks.simulate):
    """Run a scene to its end by simulate(steps), with one more step, since the last sample is taken inside this step."""
    simulate(scene.every * scene.samples + 1)
