"""Finds scenes, maps of stability and studies: each is one file in the folder of a package. Needs no YADE."""
import contextlib
import importlib
import pathlib
import sys
import traceback

from yade_scripts.errors import ParameterError


def names(package):
    """Return the names of the files of a package, sorted."""
    return sorted(path.stem for path in pathlib.Path(sys.modules[package].__file__).parent.glob("*.py") if not path.stem.startswith("_"))


def load(package, name, needed, usual):
    """Return the module of this name; what it does not declare gets its value from `usual`. Raise ParameterError if a name of `needed` is missing,
    ImportError for any other fault of the file."""
    with located(pathlib.Path(sys.modules[package].__file__).with_name(f"{name}.py")):
        found = importlib.import_module(f"{package}.{name}")
    for declared, value in usual.items():
        vars(found).setdefault(declared, value)
    demand(package, found, vars(found), needed)
    return found


def readable(names, read, broken=None):
    """Return the names that read(name) accepts. A file with a fault raises ParameterError or ImportError; with a list `broken` its name is left out,
    and the list gets the message."""
    found = []
    for name in names:
        try:
            read(name)
        except (ParameterError, ImportError) as error:
            if broken is None:
                raise
            broken.append(str(error))
        else:
            found.append(name)
    return found


@contextlib.contextmanager
def located(file, kinds=Exception):
    """Turn an exception of these kinds into an ImportError that names the file, and the line if it is known. One that names the file stays."""
    try:
        yield
    except kinds as error:
        if str(file) in str(error):
            raise
        if isinstance(error, ImportError):
            remedy = "; import what needs YADE inside a function, as inside build" * (isinstance(error, ModuleNotFoundError) and error.name == "yade")
            raise ImportError(f"{file}: {error}{remedy}", name=error.name) from None
        lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(file)]
        raise ImportError(f"{file}{''.join(f', line {line}' for line in lines[-1:])}: {type(error).__name__}: {error}; correct it") from None


def demand(package, file, declared, needed):
    """Raise ParameterError if one of the names `needed` is missing in `declared`, the {name: value} of a file, or has the value None."""
    if lacking := [name for name in needed if declared.get(name) is None]:
        raise ParameterError(f"{file.__file__} lacks {', '.join(lacking)}; {sys.modules[package].__file__} explains what the file has to declare")
