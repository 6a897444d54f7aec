"""Stores each measurement in a file results/<kind>/<name>.h5 (HDF5 with a checksum). Needs no YADE.

A measurement is a dictionary of facts and a table `rows`. A file is written completely or not at all; one that cannot be read is measured again.
"""
import io
import json
import pathlib
import sys

import h5py
import numpy as np
import pandas

from yade_scripts import results
from yade_scripts.results import provenance, sealed


def origin():
    """Return where a measurement comes from: commit, processor and, inside YADE, its version."""
    found = {"git_commit": provenance.git_commit(), "processor": provenance.processor()}
    if "yade" in sys.modules:
        from yade import config
        found["yade_version"] = config.version
    return found


def add(folder, name, facts, rows=()):
    """Write a measurement; it replaces an older one of that name."""
    results.make(folder)
    content = io.BytesIO()
    with h5py.File(content, "w") as file:
        file["facts"] = json.dumps(facts)
        for column in dict.fromkeys(key for row in rows for key in row):
            values = [row.get(column) for row in rows]
            texts = any(isinstance(value, str) for value in values)
            kind = h5py.string_dtype() if texts else int if all(isinstance(value, int) for value in values) else float
            file.create_dataset(f"rows/{column}", dtype=kind, data=[("" if texts else np.nan) if value is None else value for value in values])
    sealed.write(pathlib.Path(folder) / f"{name}.h5", content.getvalue())


def get(folder, name):
    """Return a measurement: its facts, with its table as a list of dictionaries under 'rows', None for NaN; None if no file can be read."""
    path = pathlib.Path(folder) / f"{name}.h5"
    if not path.exists():
        return None
    try:
        with sealed.open_checked(path) as file:
            columns = {column: data.asstr()[()] if data.dtype.kind == "O" else data[()] for column, data in file.get("rows", {}).items()}
            facts = json.loads(file["facts"].asstr()[()])
    except (sealed.Damaged, KeyError, ValueError, TypeError) as error:
        print(f"{path} {error}: it is measured again.", file=sys.stderr)
        return None
    rows = pandas.DataFrame(columns)
    return facts | {"rows": rows.astype(object).where(rows.notna(), None).to_dict("records")}
