"""Simulations run by YADE: prepared packings, Molecular Dynamics and Contact Dynamics on them, results as HDF5 files."""
