"""The whole picture of a Scene: axes in metres, colour bars, time. Lengths on the paper are in inches."""
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from . import drawing

# What disks can be coloured by: label, and values of a Scene.
COLOURS = {"speed": ("speed [m/s]", lambda scene: np.linalg.norm(scene.velocity, axis=1)),
           "force": ("normal forces on a disk, sum [N]", lambda scene: scene.force),
           "radius": ("radius [m]", lambda scene: scene.radius),
           "spin": ("angular velocity [rad/s]", lambda scene: scene.spin)}
LEFT, RIGHT, BOTTOM, TOP = 0.8, 0.25, 0.55, 0.35  # around the axes
NARROWEST, LOWEST = 2.6, 1.0  # axes
BAR, ROOM = 0.12, 0.85  # a colour bar, and what it takes beside the axes
FLAT, BELOW = 0.5, 0.6  # height over width of the axes up to which the bars lie below them, and what they take there
SMALL = 8  # [points] of letters


def figure(scene, shape, view, colour="speed", label=None, limits=None, forces=None, strongest=None, rotation=None, title=None):
    """Return a Figure of a Scene. shape: width and height of its axes; view [m]: widened to this shape. For the rest see cd_engine.picture."""
    (width, height), view = shape, _widened(view, *shape)
    label, values = coloured(scene, colour, label)
    limits = limits or colour_range(scene, colour, values)
    rotation = len(scene.radius) <= drawing.FEW if rotation is None else rotation
    forces = scene.depth is None if forces is None else forces
    flat, bars = height < FLAT * width, (values is not None) + bool(forces)
    right, bottom = (RIGHT, BOTTOM + BELOW * (bars > 0)) if flat else (RIGHT + ROOM * bars, BOTTOM)
    fig = Figure((LEFT + width + right, bottom + height + TOP))
    FigureCanvasAgg(fig)

    def place(x, y, wide, high):
        return fig.add_axes((x / fig.get_figwidth(), y / fig.get_figheight(), wide / fig.get_figwidth(), high / fig.get_figheight()))

    axes = place(LEFT, bottom, width, height)
    disks, chains = drawing.draw(axes, scene.position, scene.radius, scene.angle if rotation else None, values, limits,
                                 *((scene.links, scene.link_force, strongest) if forces else ()), boxes=scene.boxes, walls=scene.walls, view=view,
                                 depth=scene.depth, turned=scene.turned if rotation else None)
    axes.set_xlabel(f"{scene.names[0]} [m]", fontsize=SMALL + 1)
    axes.set_ylabel(f"{scene.names[1]} [m]", fontsize=SMALL + 1)
    axes.tick_params(labelsize=SMALL)
    for axis, length in ((axes.xaxis, width), (axes.yaxis, height)):
        axis.set_major_locator(_ticks(length))
    axes.set_title(f"t = {scene.time:.4g} s" if title is None else title, fontsize=SMALL + 2, loc="left")
    shown = [(disks, label, values)] * (values is not None) + [(chains, "normal force of a contact [N]", scene.link_force)] * (chains is not None)
    for number, (drawn, name, numbers) in enumerate(shown):
        wide = (width - 0.3 * (bars - 1)) / bars
        box = (LEFT + number * (wide + 0.3), 0.42, wide, BAR) if flat else (LEFT + width + 0.2 + number * ROOM, bottom, BAR, height)
        bar = fig.colorbar(drawn, cax=place(*box), orientation="horizontal" if flat else "vertical", extend=_extend(numbers, *drawn.get_clim()))
        bar.set_label(name, fontsize=SMALL + 1)
        bar.ax.tick_params(labelsize=SMALL)
        bar.locator = _ticks(wide if flat else height)
        bar.formatter.set_powerlimits((-2, 4))
        bar.formatter.set_useMathText(True)
        (bar.ax.xaxis if flat else bar.ax.yaxis).get_offset_text().set_fontsize(SMALL)
        bar.update_ticks()
    return fig


def _ticks(length):
    """Return the places of the numbers at an axis of `length` inches."""
    return MaxNLocator(max(2, int(length / 0.7)), steps=(1, 2, 5, 10))


def coloured(scene, colour, label=None):
    """Return the label and the values by which disks are coloured, NaN for fixed ones; values None: all disks look the same."""
    if colour is None:
        return label, None
    if isinstance(colour, str):
        name, values = COLOURS[colour][0], COLOURS[colour][1](scene)
    else:
        name, values = "", np.asarray(colour, float)
        if values.shape != scene.radius.shape:
            raise ValueError(f"picture: colour has the shape {values.shape}, but there are {len(scene.radius)} disks. Give a number for each disk, "
                             "in the order of their ids")
    return name if label is None else label, np.where(scene.fixed, np.nan, values)


def colour_range(scene, colour, values):
    """Return (low, high) of a colour scale: from 0 for speeds and forces, to either side of 0 for what has both signs."""
    if values is None:
        return None
    finite = values[np.isfinite(values)]
    low, high = (finite.min(), finite.max()) if len(finite) else (0, 0)
    if low < 0 < high or isinstance(colour, str) and colour == "spin":
        high = max(-low, high) or 1
        return -high, high
    if isinstance(colour, str) and colour in ("speed", "force"):
        # Below a radius a second a disk looks as if at rest: else the rounding errors of a packing at rest would be coloured.
        return 0, max(high, np.median(scene.radius)) if colour == "speed" else high or 1
    return (low, high) if high > low else (low, low + (abs(low) or 1))


def shape_of(view, size):
    """Return width and height [inches] of axes that show a view, the longer side `size`."""
    wide, high = view[1] - view[0], view[3] - view[2]
    return max(size * wide / max(wide, high), NARROWEST), max(size * high / max(wide, high), LOWEST)


def _widened(view, width, height):
    """Return the view [m] with what has to be added, on both sides, so that it has the shape of the axes."""
    left, right, bottom, top = view
    scale = max((right - left) / width, (top - bottom) / height)
    more_wide, more_high = (width * scale - right + left) / 2, (height * scale - top + bottom) / 2
    return left - more_wide, right + more_wide, bottom - more_high, top + more_high


def _extend(numbers, low, high):
    """Return at which ends of a colour bar numbers lie beyond it."""
    finite = numbers[np.isfinite(numbers)]
    below, above = (finite < low).any(), (finite > high).any()
    return "both" if below and above else "min" if below else "max" if above else "neither"
