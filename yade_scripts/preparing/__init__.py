"""Makes samples: disks, packings at rest under a load, deposited heaps, and further force networks of one packing."""
