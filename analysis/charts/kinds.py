"""Kinds of scenes: what a user has at hand, so that what was measured on one tells of another."""

KINDS = {
    "sliding and rolling": ("incline", "friction_angle", "stopping_distance", "slide_to_roll", "groove"),
    "impacts": ("bounce", "zeno", "cradle", "thin_wall"),
    "piles at rest": ("stack", "heavy_on_light", "pyramid", "arch", "loaded_box", "packing_at_rest"),
    "dense packings under load": ("elastic_step", "yield_ramp"),
    "flow": ("collapse",),
    "closed paths": ("two_grain_path",),
}


def of(scene):
    """The kind of a scene."""
    return next((kind for kind, scenes in KINDS.items() if scene in scenes), "other")
