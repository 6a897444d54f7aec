"""Draws disks or spheres, boundaries and contact forces by matplotlib, from plain arrays. Needs no YADE, no screen and no pyplot."""
import math

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import EllipseCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, to_rgba

from . import rendering

BOUNDARY, EDGE = "#A6A6A6", "#5A5A5A"
# Blue for disks and amber to dark red for forces: told apart without seeing red or green, and each ordered by lightness alone.
DISKS = LinearSegmentedColormap.from_list("disks", ("#F4F4F2", "#BFD7EA", "#6FA8D6", "#2C6FB0")).with_extremes(bad=BOUNDARY)
SIGNED = LinearSegmentedColormap.from_list("signed", ("#1B7837", "#A6DBA0", "#F4F4F2", "#C2A5CF", "#762A83")).with_extremes(bad=BOUNDARY)
FORCES = LinearSegmentedColormap.from_list("forces", ("#FDB863", "#E66101", "#A63603", "#5E0F00"))
WIDEST = 1.1, 0.015  # width of the line of the strongest force: at most so many median radii, and this part of the view's larger side
TIP = 0.6  # length of the tips of lines, in half widths
FEW = 5000  # disks up to which each has a visible edge
TIMES_MEAN = 5  # the widest line stands for the largest force, but for at most this times the mean
# In parts of the larger side: room around all, how far from the disks a boundary may reach to be shown as a whole, and what is shown of a larger one.
MARGIN, BESIDE, PART = 0.03, 0.5, 0.08
LEAST = 12  # sides of a view, in median radii
GLASS = 0.1, 0.35  # opacity of the faces of boundaries in space, and of their edges


def draw(axes, position, radius, angle=None, colour=None, limits=None, links=(), force=(), strongest=None, boxes=(), walls=(), view=None, depth=None,
         turned=None):
    """Draw a scene into `axes` (of matplotlib). Return (disks, chains), the collections of which colour bars can be made; chains is None if
    there are no forces.

    position, radius [m]: of each disk. angle [rad]: of each disk, whose one half is then shaded; None: no rotation is shown.
    colour: a number for each disk (NaN: drawn as a boundary), or None. limits: (low, high) of its colour scale, by default those of the numbers.
    links [m], force [N]: both ends of each contact, and its normal force, which is the width and the colour of its line. strongest [N]: the force
    of the widest line, by default that of `scale`. boxes [m]: polygons. walls: (axis that it stands across, 0 or 1, and place [m]) each.
    view [m]: (left, right, bottom, top), by default that of `bounds`. depth [m]: of each sphere of a scene in space, towards the viewer; spheres are
    then seen as such, one half of each darker if `turned`, the direction of its own x axis in the picture's x, y and depth, is given, and boxes, the
    faces of the boundaries, are of glass. Raises ValueError if arrays do not fit together.
    """
    position, radius, links, force = np.reshape(position, (-1, 2)), np.ravel(radius), np.reshape(links, (-1, 2, 2)), np.ravel(force)
    for name, array in (("radius", radius), ("angle", angle), ("colour", colour), ("depth", depth), ("turned", turned)):
        if array is not None and len(array) != len(position):
            raise ValueError(f"picture: {name} has {len(array)} values, but there are {len(position)} disks")
    if len(links) != len(force):
        raise ValueError(f"picture: there are {len(force)} forces, but {len(links)} contacts")
    axes.set_aspect("equal")
    axes.grid(False)  # yade.plot sets matplotlib to draw one
    view = bounds(position, radius, boxes, walls) if view is None else view
    axes.axis(view)
    for axis, place in walls:
        (axes.axhline if axis else axes.axvline)(place, color=EDGE, linewidth=2, zorder=1)
    face, edge = (to_rgba(colour, 1 if depth is None else opacity) for colour, opacity in zip((BOUNDARY, EDGE), GLASS))
    _add(axes, PolyCollection(list(boxes), facecolor=face, edgecolor=edge, linewidth=0.8, zorder=1))
    values = np.ma.masked_invalid(np.zeros(len(radius)) if colour is None else np.asarray(colour, float))
    scheme = SIGNED if limits is not None and limits[0] < 0 < limits[1] else DISKS
    if depth is None:
        disks = EllipseCollection(2 * radius, 2 * radius, np.zeros(len(radius)), units="xy", offsets=position, offset_transform=axes.transData,
                                  cmap=scheme, edgecolor=EDGE, linewidth=0.4 if len(radius) <= FEW else 0.1, zorder=2)
        _add(axes, disks)
    else:
        disks = ScalarMappable(cmap=scheme)
    disks.set_array(values)
    if limits is not None:
        disks.set_clim(*limits)
    if depth is not None:
        axes.imshow(rendering.spheres(position, depth, radius, disks.to_rgba(values), view, turned), extent=view, zorder=2, aspect="equal")
    if angle is not None:
        _add(axes, PolyCollection(_halves(position, radius, np.asarray(angle)), facecolor=(0, 0, 0, 0.11), linewidth=0, zorder=3))
    if not len(force):
        return disks, None
    top = scale(force) if strongest is None else strongest
    order = np.argsort(force, kind="stable")  # the strongest above all
    widest = min(WIDEST[0] * np.median(radius), WIDEST[1] * max(view[1] - view[0], view[3] - view[2]))
    chains = PolyCollection(_lines(links[order], widest * np.minimum(force[order] / top, 1)), cmap=FORCES, linewidth=0, zorder=4)
    chains.set_array(force[order])
    chains.set_clim(0, top)
    _add(axes, chains)
    return disks, chains


def scale(force):
    """Return the force [N] that the widest line stands for: the largest, but at most 5 times the mean, so that one impact does not hide the rest."""
    return min(force.max(), TIMES_MEAN * force.mean())


def links(position, body_ids, contact_ids, contact_point):
    """Return both ends [m] of each contact: the centres of its two disks, or the point of contact where a body is no disk.

    The arrays are those of a result file's snapshot (`yade_scripts/results/schema.py`).
    """
    order = np.argsort(body_ids)
    found = order[np.minimum(np.searchsorted(body_ids, contact_ids, sorter=order), len(order) - 1)]
    is_disk = np.asarray(body_ids)[found] == contact_ids
    return np.where(is_disk[:, :, None], np.asarray(position)[found], np.asarray(contact_point)[:, None])


def hull(position, radius):
    """Return the lower left and the upper right corner [m] of the rectangle that holds all disks."""
    return (position - radius[:, None]).min(axis=0), (position + radius[:, None]).max(axis=0)


def bounds(position, radius, boxes=(), walls=()):
    """Return the view (left, right, bottom, top) [m] that holds all disks, the boundaries beside them, and of large boundaries the nearest part."""
    low, high = hull(position, radius)
    middle, least = (low + high) / 2, LEAST * np.median(radius)
    if (high - low).max() < least:
        low, high = middle - least / 2, middle + least / 2
    side = (high - low).max()
    (first_of, last_of), (near_first, near_last) = ((low - part * side, high + part * side) for part in (BESIDE, PART))
    for corners in [np.array(box) for box in boxes] + [np.where(np.arange(2) == axis, place, middle)[None] for axis, place in walls]:
        first, last = corners.min(axis=0), corners.max(axis=0)
        if (first < first_of).any() or (last > last_of).any():
            first, last = np.maximum(first, near_first), np.minimum(last, near_last)
        if (first <= last).all():
            low, high = np.minimum(low, first), np.maximum(high, last)
    margin = MARGIN * (high - low).max()
    return low[0] - margin, high[0] + margin, low[1] - margin, high[1] + margin


def _add(axes, collection):
    axes.add_collection(collection, autolim=False)


def _halves(position, radius, angle):
    """Return the half of each disk to the left of its direction `angle`, as a polygon [m]."""
    turn = angle[:, None] + np.linspace(0, math.pi, 13)
    return position[:, None] + radius[:, None, None] * np.stack((np.cos(turn), np.sin(turn)), axis=2)


def _lines(ends, width):
    """Return lines of a width [m] as polygons, which keep their proportion to the disks at every size. Their tips close the joints of chains."""
    along = ends[:, 1] - ends[:, 0]
    along /= np.maximum(np.hypot(*along.T), np.finfo(float).tiny)[:, None]
    along *= width[:, None] / 2
    beside = np.stack((-along[:, 1], along[:, 0]), axis=1)
    first, last = ends[:, 0], ends[:, 1]
    return np.stack((first + beside, last + beside, last + TIP * along, last - beside, first - beside, first - TIP * along), axis=1)
