"""Pictures and films of scenes of springs or of rigid grains, without a screen: `picture`, `film`, and `drawing.draw` for plain arrays.

Matplotlib is imported when the first picture is drawn. Figures and backend of pyplot stay as they are.
"""
import os

from . import scene
from .. import engine_methods

PICTURES, FILMS = (".png", ".pdf", ".svg"), (".gif", ".mp4", ".png")
COLOURS = ("speed", "force", "radius", "spin")


def picture(path, colour="speed", *, label=None, limits=None, forces=None, strongest=None, rotation=None, view=None, look=None, title=None, size=6.0,
            dpi=150):
    """Draw the scene of the running YADE into a file: disks, boundaries and the forces between them. Its ending is .png, .pdf or .svg.

    colour     what disks are coloured by: "speed" [m/s], "force" (the sum of the sizes of all normal forces on a disk [N]), "radius" [m], "spin"
               (angular velocity [rad/s]), None, or an array with a number for each disk (sphere) in the order of the ids. Disks that nothing moves
               (blockedDOFs "xyzXYZ") are grey, as boundaries are
    label      text at the colour bar, for an array with its unit
    limits     (low, high) of the colour bar, in its unit; by default from the least to the largest value, for speeds and forces from 0
    forces     whether a line for each loaded contact shows the size of its normal force by width and colour; by default in planar
               scenes only
    strongest  the force [N] of the widest line; larger ones have the same width. By default the largest, but at most 5 times the mean of all
    rotation   whether one half of each disk is shaded, which shows how far it has turned; by default up to 5000 disks
    view       (left, right, bottom, top) [m]; by default all disks, and what boundaries are near
    look       of a scene in space: the direction in which one looks, without perspective; by default (0.35, 1, -0.35). Up is against gravity, or z.
               The view counts from the origin, to the right and upwards as one sees it; the spin is that about the direction to the viewer
    title      text above; by default the time
    size, dpi  longer side of the axes [inches], pixels per inch

    The plane is that in which the disks are kept by their blockedDOFs, or else that in which they all lie. Where there is none, or with `look`,
    spheres are drawn as seen in space and boundaries, facets too, as of glass. Other shapes than Sphere, Box, Wall and Facet are not drawn. Raises
    ValueError for a scene without disks, for an argument that cannot be, and for another ending; FileNotFoundError if
    the folder is missing; RuntimeError while a run goes on in the background; ImportError without matplotlib.
    """
    path = _target("picture", path, PICTURES)
    options = _checked("picture", colour, limits, strongest, view, look, size, dpi)
    layout, seen = _layout(), scene.read(options.pop("look"))
    view = options.pop("view") or layout.drawing.bounds(seen.position, seen.radius, seen.boxes, seen.walls)
    shape = layout.shape_of(view, options.pop("size"))
    layout.figure(seen, shape, view, label=label, forces=forces, rotation=rotation, title=title, **options).savefig(path, dpi=dpi)


def film(path, every, colour="speed", *, fps=None, label=None, limits=None, forces=None, strongest=None, rotation=None, view=None, look=None,
         size=5.0, dpi=100):
    """Return an engine for O.engines that adds a frame to a film at each `every` [s] of the scene's time, and one at the start of the run.

        O.engines = O.engines + [cd_engine.film("drum.gif", every=0.05)]

    The ending of `path` says the format: .gif; .mp4, which needs the program ffmpeg; .png for numbered pictures (drum-00000.png). A .gif and the
    pictures are complete after each frame; when O.load or O.reload brings the scene back, they go on from there, also in another process. An .mp4 is
    complete when YADE has ended, in whatever way, and begins anew after O.load and O.reload.

    fps: frames a second of the film, by default those of real time, but 5 at least and 25 at most. The other arguments are those of `picture`;
    colour must be a name or None. Where `limits`, `strongest` or `view` are not given, they grow when frames need it, and never shrink; the frames
    keep the shape of the first, so give the view if the grains will spread. Several films need several paths. A frame takes 0.1 s of computing for
    200 disks and 3 s for 50 000 with 120 000 contacts. Raises as `picture` does, what concerns the scene at the first frame; ValueError if `every` or
    `fps` is not a number above 0, or if there is no ffmpeg; ImportError for a .gif without PIL.
    """
    from . import frames
    path = _target("film", path, FILMS)
    options = _checked("film", colour, limits, strongest, view, look, size, dpi)
    if not isinstance(colour, (str, type(None))):
        raise ValueError(f"film: colour must be one of {', '.join(map(repr, COLOURS))} or None")
    for name, value in (("every", every), ("fps", fps)):
        if not (name == "fps" and value is None or engine_methods.is_number(value) and value > 0):
            raise ValueError(f"film: {name}={value!r} must be a number above 0")
    _layout()
    frames.check(path)
    return frames.engine(path, float(every), options | dict(fps=float(fps or min(max(1 / every, 5), 25)), dpi=float(dpi), label=label,
                                                            forces=forces, rotation=rotation))


def _target(name, path, endings):
    """Return the path of a file as text. Raise ValueError for another ending, FileNotFoundError if its folder is missing."""
    path = os.fspath(path)
    folder, ending = os.path.dirname(path), os.path.splitext(path)[1].lower()
    if ending not in endings:
        raise ValueError(f"{name}: {path!r} must end in {', '.join(endings[:-1])} or {endings[-1]}")
    if folder and not os.path.isdir(folder):
        raise FileNotFoundError(f"{name}: there is no folder {folder!r} for {path!r}")
    return path


def _checked(name, colour, limits, strongest, view, look, size, dpi):
    """Return these arguments of a figure with plain numbers (dpi is only checked). Raise ValueError for one that cannot be."""
    if isinstance(colour, str) and colour not in COLOURS:
        raise ValueError(f"{name}: colour={colour!r} must be one of {', '.join(map(repr, COLOURS))}, None" + " or an array" * (name == "picture"))
    for word, value in (("size", size), ("dpi", dpi), ("strongest", strongest)):
        if not (word == "strongest" and value is None or engine_methods.is_number(value) and value > 0):
            raise ValueError(f"{name}: {word}={value!r} must be a number above 0")
    for word, value, meaning in (("limits", limits, ("low", "high")), ("view", view, ("left", "right", "bottom", "top"))):
        if value is None:
            continue
        try:
            good = len(value) == len(meaning) and all(map(engine_methods.is_number, value)) and all(a < b for a, b in zip(value[::2], value[1::2]))
        except TypeError:
            good = False
        if not good:
            raise ValueError(f"{name}: {word}={value!r} must be ({', '.join(meaning)}), the smaller number of a pair first")
    try:
        good = look is None or len(look) == 3 and all(map(engine_methods.is_number, look)) and any(look)
    except TypeError:
        good = False
    if not good:
        raise ValueError(f"{name}: look={look!r} must be a direction (x, y, z)")
    limits, view, look = (value if value is None else tuple(map(float, value)) for value in (limits, view, look))
    return dict(colour=colour, limits=limits, strongest=None if strongest is None else float(strongest), view=view, look=look, size=float(size))



def _layout():
    try:
        from . import layout
    except ModuleNotFoundError as error:
        raise ImportError(f"cd_engine's pictures need the Python package {error.name}, on Debian python3-{error.name}") from None
    return layout
