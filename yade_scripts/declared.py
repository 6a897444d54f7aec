"""Finds scenes, maps of stability and studies: each is one file in the folder of a package. Needs no YADE."""
import contextlib
import importlib
import pathlib
import sys


def names(package):
    """Return the names of the files of a package, sorted."""
    return sorted(path.stem for path in pathlib.Path(sys.modules[package].__file__).parent.glob("*.py") if not path.stem.startswith("_"))


def load(package, name, needed, usual):
    """Return the module of this name; what it does not declare gets its value from `usual`. Raise ParameterError if a name of `needed` is missing."""
    with located(pathlib.Path(sys.modules[package].__file__).with_name(f"{name}.py")):
        found = importlib.import_module(f"{package}.{name}")
    for declared, value in usual.items():
        vars(found).setdefault(declared, value)
    demand(package, found, vars(found), needed)
    return found


@contextlib.contextmanager
def located(file):
    """Add the file to the message of an import that fails in it."""
    try:
        yield
    except ImportError as error:
        remedy = "; import what needs YADE inside a function, as inside build" * (error.name == "yade")
        raise ImportError(f"{file}: {error}{remedy}", name=error.name) from None


def demand(package, file, declared, needed):
    """Raise ParameterError if one of the names `needed` is missing in `declared`, the {name: value} of a file, or has the value None."""
    from yade_scripts.parameters import ParameterError
    if lacking := [name for name in needed if declared.get(name) is None]:
        raise ParameterError(f"{file.__file__} lacks {', '.join(lacking)}; {sys.modules[package].__file__} explains what the file has to declare")
