"""Tables on a cluster: rows as array jobs of Slurm."""
