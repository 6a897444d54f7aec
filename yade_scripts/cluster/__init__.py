"""Runs the rows of tables on a cluster, as array jobs of Slurm."""
