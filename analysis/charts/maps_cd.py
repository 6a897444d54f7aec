"""Stability maps: where rigid contacts fail."""

from analysis.charts import maps

TITLE = "Where rigid contacts fail"
QUESTION = "Which steps, sweeps, tolerances, masses, heights and coefficients does Contact Dynamics bear?"
MAPS = ("cd_sweeps", "cd_tolerance", "cd_mass_ratio", "cd_friction", "cd_load_step", "cd_time_step", "cd_impact")


def publish(results, folder, full):
    """See the package."""
    maps.publish("maps_cd", TITLE, QUESTION, MAPS, results, folder, full)
