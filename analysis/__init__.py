"""Reading, checking and drawing result files; needs NumPy, h5py and Matplotlib, never YADE."""
