"""Packages that not every release of Debian has: a test that needs one skips if it is not installed, and names it.

A package that is installed but does not load is a failure.
"""
import ctypes
import importlib
import subprocess

import pytest


def _package(name):
    """Skip unless Debian's package is here."""
    said = subprocess.run(["dpkg-query", "-W", "-f", "${db:Status-Status}", name], capture_output=True, text=True)
    if said.stdout != "installed":
        pytest.skip(f"{name} is not installed")


def siconos():
    """Siconos's solvers, a Python module."""
    _package("python3-siconos")
    return importlib.import_module("siconos.numerics")


def libfclib():
    """The library of the FCLIB format."""
    _package("libfclib0")
    return ctypes.CDLL("libfclib.so.0")
