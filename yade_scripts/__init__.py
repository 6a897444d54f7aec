"""Simulations run by YADE: prepared packings, Molecular Dynamics and Contact Dynamics on them, results as HDF5 files."""

FOLDER = "results"  # the folder of the result files, below the current one, if a command names no other
