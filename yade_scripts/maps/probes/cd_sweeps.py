"""A column under a fixed number of sweeps."""
from yade_scripts.maps.probes import column

STEPS = 50


def probe(case):
    """See the map of this name."""
    return column.judge(*column.stand(case["disks"], STEPS, fixedIterations=case["sweeps"], warmStart=case["start"] == "warm"))
