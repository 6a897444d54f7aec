"""Charts of speed against accuracy and maps of stability: drawn from the records in results/, published as figures, a table and their origin.

A chart is a module of this package with

    publish(results, folder, full)    writes <name>.json, <name>.csv and its figures into `folder`; load.ResultError if nothing was run

The JSON file says title, question, answer, figures [{file, title}], and where it comes from (origin.py); the report shows it. The table has
the column `status`, empty where a row is a result. Accuracy is a relative error: |measured - exact| over a scale that the scene names,
the largest of all that is known of it.
"""

import importlib
import importlib.util

from analysis import load

# Of the report.
ORDER = ("work_precision", "profile", "cost_against_size", "asked", "maps_md", "maps_cd", "maps_walls")
FOLDER = "charts"  # below the folder of the studies' figures


def names():
    """The charts there are, in the order of the report."""
    return [name for name in ORDER if importlib.util.find_spec(f"{__name__}.{name}")]


def publish_all(results, folder, full):
    """Publish every chart that has records; {name: reason} of those that have none."""
    left = {}
    for name in names():
        try:
            importlib.import_module(f"{__name__}.{name}").publish(results, folder, full)
        except load.ResultError as error:
            left[name] = error.what
    return left
