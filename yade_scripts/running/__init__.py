"""Runs a scene in YADE: disks, engines of both methods, loaded walls, samples, checks, checkpoints, and many runs at a time."""
