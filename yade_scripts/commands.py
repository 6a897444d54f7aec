"""Shared by all commands: common options, and one sentence instead of a traceback for a user's mistake."""
import argparse
import contextlib
import errno
import functools
import importlib
import math
import os
import pathlib
import sys

from yade_scripts import FOLDER
from yade_scripts.errors import ParameterError

MISTAKE = 2  # exit status of a command that cannot do what it was asked for


def parser(doc, *shared, **more):
    """Return an argument parser; its --help shows the first paragraph of a module's docstring `doc`, then the options, then the rest."""
    first, _, rest = doc.partition("\n\n")
    raw = argparse.RawDescriptionHelpFormatter
    return add(argparse.ArgumentParser(description=first, epilog=rest, formatter_class=raw, **more), *shared)


def add(options, *shared):
    """Return a parser with arguments that several commands have: "row", "tables", "--results", "--jobs", "--hours"."""
    known = {"row": dict(nargs="*", metavar="name=value", help="parameters; the list: /usr/bin/python3 -m yade_scripts.parameters"),
             "--results": dict(metavar="FOLDER", default=FOLDER, help="folder of the result files (default: %(default)s)"),
             "tables": dict(nargs="+", metavar="TABLE", help="tables in yade-batch's format"),
             "--jobs": dict(type=whole(1), default=2, metavar="N", help="runs at the same time (default: %(default)s)"),
             "--hours": dict(type=positive, default=math.inf, metavar="H", help="end a run that takes longer; the same command continues it from its "
                             "last checkpoint if it has one (default: no limit)")}
    for name in shared:
        options.add_argument(name, **known[name])
    return options


def add_extent(options, quick="a first version, minutes", full="the full version, hours; it can be stopped and started again"):
    extent = options.add_mutually_exclusive_group()
    extent.add_argument("--quick", action="store_true", help=f"{quick} (default)")
    extent.add_argument("--full", action="store_true", help=full)


def whole(least):
    """Return a converter of arguments for argparse, which accepts integers from `least` on."""
    def convert(text):
        if not text.isascii() or not text.isdecimal() or len(text) > 9 or int(text) < least:
            raise argparse.ArgumentTypeError(f"{text!r}: must be a whole number from {least} on")
        return int(text)
    return convert


def positive(text):
    """Convert an argument to a number above 0; raise argparse.ArgumentTypeError for anything else."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text!r}: must be a number above 0, such as 1e-3")
    return value


def cure(error):
    """Return what to do about an OSError, in words."""
    return "free some space" if error.errno in (errno.ENOSPC, errno.EDQUOT) else "correct this"


class Output:
    """A stream of output that ends no command: where its reader has gone, as after `| head`, or where it is closed, what is written goes nowhere."""

    def __init__(self, stream):
        self.stream = open(os.devnull, "w", encoding="utf-8") if stream is None else stream
        if hasattr(self.stream, "reconfigure"):
            self.stream.reconfigure(errors="backslashreplace")  # for characters that the locale cannot write

    def __getattr__(self, name):
        return getattr(self.stream, name)

    def write(self, text):
        return self._lasting(self.stream.write, text)

    def flush(self):
        self._lasting(self.stream.flush)

    def _lasting(self, function, *arguments):
        try:
            return function(*arguments)
        except BrokenPipeError:  # what could not be written stays in the stream, which writes it to the new place
            os.dup2(os.open(os.devnull, os.O_WRONLY), self.stream.fileno())


def started(file):
    """Tell whether the command line started this file. Otherwise, as in execfile at YADE's console, the arguments are not meant for it."""
    return bool(sys.argv) and os.path.realpath(sys.argv[0]) == os.path.realpath(file)


def script(name, file):
    """Do what a script does, and exit: import it as the module `name` and call main(), before it begin() if the command line started the script.

    A module works in every way of starting: functions of a script in execfile at YADE's console do not find the names of their own file.
    """
    former, own = sys.argv, started(file)

    def main(_):
        module = importlib.import_module(name)
        if own:
            vars(module).get("begin", lambda: None)()
        return module.main()
    sys.argv = former if own else [file]
    try:
        sys.exit(command(pathlib.Path(file).stem)(main)())
    finally:
        sys.argv = former


def command(name):
    """Return a decorator for a function main(arguments) -> exit status: it reports mistakes in one sentence and returns the status 2 for them."""
    def decorate(main):
        @functools.wraps(main)
        def call(arguments=None):
            with contextlib.redirect_stdout(Output(sys.stdout)), contextlib.redirect_stderr(Output(sys.stderr)):
                try:
                    return main(arguments)
                except (ParameterError, ImportError, OSError) as error:
                    no_yade = isinstance(error, ModuleNotFoundError) and error.name == "yade"
                    print(f"{name}: " + (f"start it by YADE: yade -n -x {sys.argv[0]}" if no_yade else str(error)), file=sys.stderr)
                    return MISTAKE
                finally:
                    sys.stdout.flush()
        return call
    return decorate
