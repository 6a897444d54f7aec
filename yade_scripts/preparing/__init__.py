"""Makes samples: disks, packings at rest under a load, heaps, other force networks of one packing."""
