"""Deposits disks in a trough without dynamics: each disk falls and rolls down until two contacts hold it. Needs no YADE.

The disks of the heap touch without overlap. The heap is the same for all methods and has a solid fraction of about 0.8 (Visscher and Bolsterli 1972).
"""
import math

import numpy as np

CLOSE = 1e-12  # over the largest radius: round-off of a position in contact


def deposit(radii, width, drop):
    """Return the centres, rows (x, y) [m], of disks of `radii` [m] that fall one by one between walls at x = 0 and `width` [m] to a floor at y = 0.

    drop() draws the place in [0, 1] of the free width at which the next disk falls. ValueError if a disk does not fit between the walls.
    """
    heap = _Heap(len(radii), max(radii), width)
    for radius in radii:
        if 2 * radius >= width:
            raise ValueError(f"a disk of radius {radius:g} m does not fit between walls {width:g} m apart")
        heap.add(radius + drop() * (width - 2 * radius), radius)
    return heap.place


class _Heap:
    """The disks that have come to rest, out of `count` in all."""

    def __init__(self, count, largest, width):
        self.place, self.radius = np.zeros((count, 2)), np.zeros(count)
        self.count, self.close, self.width = 0, CLOSE * largest, width

    def add(self, x, radius):
        y, under = self._fall(x, math.inf, radius)
        while under is not None:
            x, y, under = self._roll(x, y, radius, under)
        self.place[self.count], self.radius[self.count] = (x, y), radius
        self.count += 1

    def _fall(self, x, y, radius):
        """Return (height at which it stops, disk that it meets) for a vertical fall from (x, y); None for the floor."""
        dx = self.place[:self.count, 0] - x
        reach = self.radius[:self.count] + radius
        below = np.flatnonzero((np.abs(dx) < reach - self.close) & (self.place[:self.count, 1] < y))
        tops = self.place[below, 1] + np.sqrt(reach[below]**2 - dx[below]**2)
        tops = np.where(tops <= y + self.close, tops, -math.inf)  # disks above it do not stop the fall
        if len(tops) == 0 or tops.max() <= radius:
            return radius, None
        return tops.max(), below[tops.argmax()]

    def _roll(self, x, y, radius, under):
        """Roll down over the disk `under`. Return (x, y, disk over which it rolls next), None if it rests."""
        (cx, cy), reach = self.place[under], self.radius[under] + radius
        side = 1 if x >= cx else -1
        # Angles from the top of `under` to the side it rolls to; it leaves the disk at 90 degrees.
        now = math.atan2(side * (x - cx), y - cy)
        stop, end = None, math.pi / 2
        wall = (self.width - radius - cx if side > 0 else cx - radius) / reach
        if wall < 1:
            stop, end = "wall", math.asin(max(wall, 0))
        if -1 < (radius - cy) / reach < 1 and math.acos((radius - cy) / reach) < end:
            stop, end = "floor", math.acos((radius - cy) / reach)
        angles = self._meetings(cx, cy, reach, radius, under, side)
        later = np.where(angles > now + 1e-9, angles, math.inf)
        if len(later) and later.min() < end:
            stop, end = int(later.argmin()), later.min()
        x, y = cx + side * reach * math.sin(end), cy + reach * math.cos(end)
        if stop is None:
            return (x, *self._fall(x, y, radius))
        if stop in ("wall", "floor"):
            return x, y, None
        return x, y, None if side * (self.place[stop, 0] - x) >= 0 else stop

    def _meetings(self, cx, cy, reach, radius, under, side):
        """Return for every disk the angle at which a disk that rolls over `under` meets it, infinite if it does not."""
        dx, dy = side * (self.place[:self.count, 0] - cx), self.place[:self.count, 1] - cy
        distance, other = np.hypot(dx, dy), self.radius[:self.count] + radius
        near = (distance < reach + other) & (distance > abs(reach - other)) & (np.arange(self.count) != under)
        angles = np.full(self.count, math.inf)
        cosine = (reach**2 + distance[near]**2 - other[near]**2) / (2 * reach * distance[near])
        # At the first contact the directions from `under` to the rolling disk and to the other one differ by acos(c). Few disks are near, and
        # numpy's own arctan2 and arccos give other last bits with AVX-512 than without.
        angles[near] = [math.atan2(x, y) - math.acos(c) for x, y, c in zip(dx[near], dy[near], np.clip(cosine, -1, 1))]
        return angles
