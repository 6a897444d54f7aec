"""Scenes, maps of stability and studies: one file each, found by its presence in the folder of a package. Needs no YADE."""
import importlib
import pathlib
import sys


def names(package):
    """Return the names of the files of a package, sorted."""
    return sorted(path.stem for path in pathlib.Path(sys.modules[package].__file__).parent.glob("*.py") if not path.stem.startswith("_"))


def load(package, name, needed, usual):
    """Return the file of a name, with {name: value} of `usual` for what it need not declare. Raise ParameterError if it lacks what is needed."""
    found = importlib.import_module(f"{package}.{name}")
    for declared, value in usual.items():
        vars(found).setdefault(declared, value)
    demand(package, found, vars(found), needed)
    return found


def demand(package, file, declared, needed):
    """Raise ParameterError if {name: value} that a file declares lacks something that is needed, or has None for it."""
    from yade_scripts.parameters import ParameterError
    if lacking := [name for name in needed if declared.get(name) is None]:
        raise ParameterError(f"{file.__file__} lacks {', '.join(lacking)}; {sys.modules[package].__file__} lists what such a file has")
