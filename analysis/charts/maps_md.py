"""Stability maps: where springs fail."""

from analysis.charts import maps

TITLE = "Where springs fail"
QUESTION = "How long a step do springs with dashpots bear, alone and in a packing?"
MAPS = ("md_contact", "md_packing")


def publish(results, folder, full):
    """See the package."""
    maps.publish("maps_md", TITLE, QUESTION, MAPS, results, folder, full)
