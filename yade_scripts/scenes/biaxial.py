"""The paper's experiment: a packing is prepared under P0, then sigma2 changes (eqs. 1 and 7, Figs. 3 to 5); sigma1 or the mean stress stays P0."""

from yade_scripts import parameters
from yade_scripts.errors import ParameterError

TITLE = "Biaxial test of a dense packing"
KIND = "dense packings under load"
HORIZON = "Nothing is known exactly; runs of different methods are compared sample by sample, by statistics once grains rearrange."
LEFT_OUT = "the third dimension, gravity and the elasticity of the walls, as in the paper"
DEFAULTS = {}

# Number of snapshots of a ramp, which has no load maximum before it ends, and of a single cycle: enough to follow single contacts.
SNAPSHOTS = 40


def check(full):
    """Check that the solver starts from the forces of network_seed."""
    if full["method"] == "CD" and full["network_seed"] and not full["warm_start"]:
        raise ParameterError(f"network_seed = {full['network_seed']}: has no effect with warm_start = False, since its forces are the solver's first "
                             "guess; set warm_start = True")


def build(full, folder, load=None):
    """Load the prepared packing (made if it is missing) and set the engines of the row's method, with the contact forces of the preparation or, with
    network_seed, others.

    load: settings of PlateLoads, if the load is not the row's `loading`.
    """
    from yade_scripts.preparing import force_network, prepare
    from yade_scripts.running import loading, stage
    checksum = prepare.load(full, folder)
    per_cycle, samples = full["records_per_cycle"], full["records_per_cycle"] * full["cycles"]
    snapshots = {per_cycle // 2, per_cycle, samples - per_cycle // 2}
    if full["loading"] == "ramp" or full["cycles"] == 1:
        snapshots |= set(range(0, samples, max(1, samples // SNAPSHOTS)))
    scene = stage.scene(full, state_sha256=checksum, snapshots=snapshots, kept={})
    load = load or loading.of_row(full, parameters.pressure(full))
    if full["method"] == "CD" and full["network_seed"]:
        stage.load_walls(full, scene, load)
        force_network.replace(full["network_seed"], full["network_perturbation"])
    stage.load_walls(full, scene, load)
    return scene
