"""Stability maps: where walls fail."""

from analysis.charts import maps

TITLE = "Where walls fail"
QUESTION = "When do servo-driven walls carry their load, and what gets through a wall?"
MAPS = ("servo", "tunnelling")


def publish(results, folder, full):
    """See the package."""
    maps.publish("maps_walls", TITLE, QUESTION, MAPS, results, folder, full)
