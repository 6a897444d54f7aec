"""What a mean of a flow costs by either method, with 5000 disks."""
from analysis.studies.flows import COARSE, COARSER, FINE, HARDER, MIDDLE, QUANTITY, STIFF, draw, rows_of, summarize

__all__ = ["draw", "summarize"]

TITLE = "Flows of 5000 disks"
QUESTION = "Does what holds for flows of 500 disks hold for ten times as many: the settings that suffice, and the cost of each method?"
ORDER = 21.5  # in the report
FINER = FINE | {"cd_dt": 5e-4}
SEEDS = (1, 2, 3)
# Springs of 2e6 N/m are left out: their disks overlap by more than a tenth of a radius.
ROWS = {"quick": rows_of("filling", 1000, [COARSER, COARSE, MIDDLE], 1),
        "full": [row for seed in SEEDS for scene in QUANTITY
                 for row in rows_of(scene, 5000, [FINER, FINE, COARSER, COARSE, MIDDLE, HARDER, STIFF], seed)]}
