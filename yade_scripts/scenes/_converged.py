"""Known quantities of flows: means over many runs, in place of exact values. Needs no YADE."""
from yade_scripts import parameters
from yade_scripts.scenes import Known


def converged(full, found, same, extra):
    """Return a list of Known for quantities whose exact value is a mean over many runs; empty if the row differs from those runs.

    found: {disks: ({name: (mean, standard deviation of one run)}, how it was found)}. same: {parameter: value of those runs}.
    extra: that of the Scene, with a unit and a function for each name.
    """
    if full["disks"] not in found or any(full[name] != value for name, value in same.items()) or parameters.restitution(full) > 0.01:
        return []
    quantities, how = found[full["disks"]]
    return [Known(name, extra[name][0], mean, extra[name][2], source=f"converged: {how}; standard deviation of one run {deviation}",
                  deviation=deviation) for name, (mean, deviation) in quantities.items()]
