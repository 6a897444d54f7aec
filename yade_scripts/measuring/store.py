"""Stores each measurement in a file results/<kind>/<name>.h5 (HDF5 with a checksum). Needs no YADE.

A measurement is a dictionary of facts and a table `rows`. Its name follows from its facts; a renamed file is refused. A file is written
completely or not at all. A measurement whose file cannot be read is made again.
"""
import io
import json
import pathlib
import sys

import h5py
import pandas

from yade_scripts import parameters, results
from yade_scripts.errors import ResultError
from yade_scripts.results import provenance, sealed

ACCURACY = "accuracy"  # the parameter of yade_scripts/accuracy.py, which is not in the registry
MARK = b"facts\0"  # the name of a dataset that only measurements have, as HDF5 writes it


def origin():
    """Return where a measurement comes from: commit, processor and, inside YADE, its version."""
    found = {"git_commit": provenance.git_commit(), "processor": provenance.processor()}
    if "yade" in sys.modules:
        from yade import config
        found["yade_version"] = config.version
    return found


def split(row):
    """Return (the row of parameters, the accuracy asked for or None)."""
    own = {name: value for name, value in row.items() if name != ACCURACY}
    return own, row.get(ACCURACY)


def name_of(facts):
    """Return the name of the measurement of a row of a chart, of a case of a map, or of a piece of the benchmark and its build."""
    if "row" in facts:  # scene, method and hash as in the name of a result file, and the accuracy if one is asked for
        own, asked = split(facts["row"])
        return parameters.result_name(parameters.complete(own)) + (f"-{ACCURACY}-{asked:g}" if asked else "")
    if "map" in facts:
        return f"{facts['map']}-{parameters.digest(facts['case'])}"
    return f"{facts['table']}-{parameters.digest([facts[name] for name in ('table', 'piece', 'settings', 'build')])}"


def add(folder, facts, rows=()):
    """Write a measurement with its origin; it replaces an older one of its name."""
    results.make(folder)
    content = io.BytesIO()
    with h5py.File(content, "w") as file:
        file["facts"] = json.dumps(origin() | facts)
        for column, values in pandas.DataFrame(rows).items():
            if values.map(type).eq(str).any():
                file.create_dataset(f"rows/{column}", data=values.fillna("").to_numpy(), dtype=h5py.string_dtype())
            else:
                file[f"rows/{column}"] = pandas.to_numeric(values)  # None becomes NaN
    sealed.write(pathlib.Path(folder) / f"{name_of(facts)}.h5", content.getvalue())


def get(folder, name):
    """Return a measurement as `load` does; None if no file can be used."""
    path = pathlib.Path(folder) / f"{name}.h5"
    try:
        return load(path) if path.exists() else None
    except ResultError as error:
        print(f"{error}; it is measured again", file=sys.stderr)
        return None


def load(path):
    """Return the facts of a measurement, and under 'rows' its table as a list of dictionaries, with None for NaN.

    Raise ResultError if it cannot be used.
    """
    path = pathlib.Path(path)
    try:
        with sealed.open_checked(path, MARK) as file:
            columns = {column: data.asstr()[()] if data.dtype.kind == "O" else data[()] for column, data in file.get("rows", {}).items()}
            facts = json.loads(file["facts"].asstr()[()])
        own = name_of(facts)
    except sealed.Damaged as error:
        raise ResultError(path, str(error)) from None
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise ResultError(path, f"holds no measurement of this program ({error})") from None
    if own != path.stem:
        raise ResultError(path, f"holds another measurement than its name says ({own})")
    rows = pandas.DataFrame(columns)
    return facts | {"rows": rows.astype(object).where(rows.notna(), None).to_dict("records")}
