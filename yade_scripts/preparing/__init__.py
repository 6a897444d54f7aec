"""Makes samples: packings at rest under a load, and further force networks of one packing."""
