"""A column under a tolerance."""
from yade_scripts.maps.probes import column

STEPS = 20


def probe(case):
    """See the map of this name."""
    return column.judge(*column.stand(case["disks"], STEPS, method=case["method"], tolerance=case["tolerance"]))
