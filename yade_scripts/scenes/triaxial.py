"""The paper's experiment in space: spheres are prepared under P0 on all sides, then the stress along y changes (eqs. 1, 7); sigma1 = sigma3 = P0."""

from yade_scripts.errors import ParameterError

TITLE = "Triaxial test of a dense packing of spheres"
KIND = "dense packings under load"
HORIZON = "Nothing is known exactly; runs of different methods are compared sample by sample, by statistics once grains rearrange."
LEFT_OUT = "gravity and the elasticity of the walls, as in the paper"
IN_SPACE = True
# P0 = pressure_ratio kn over the mean diameter. Grains of this P0/k_n move by their inertia, R sqrt(rho/P0), seven times as fast as the disks of the
# same row, which are 1 m long; so a period is a seventh and the ramp seven times as steep.
DEFAULTS = dict(disks=2000, period=0.15, cd_dt=4e-4, ramp_rate=0.7)
ALLOWED = dict(stress_path=("constant",), network_seed=(0,), tangential_law=("standard", "avoid_ratcheting"))


def check(full):
    """Check that the row asks for what a box of spheres can do."""
    for name, allowed in ALLOWED.items():
        if full[name] not in allowed:
            raise ParameterError(f"{name} = {full[name]}: the scene triaxial runs with {name} = {' or '.join(map(str, allowed))} only")


def build(full, folder):
    """Load the prepared packing (made if it is missing) and set the engines of the row's method."""
    from yade_scripts.scenes import biaxial
    return biaxial.build(full, folder)
