"""Spheres as one sees them in space, as an image: nearer ones hide others, light falls from above left."""
import numpy as np

SIDE = 1200  # pixels of the longer side
LIGHT = np.array([-0.4, 0.6, 0.69])  # unit vector in the picture's right, up and towards the viewer
DARK, LIT = 0.45, 0.55  # brightness in the shadow, and what the light adds
HALF = 0.8  # brightness of the half of a sphere that shows its rotation


def spheres(position, depth, radius, colour, view, turned=None):
    """Return an image (rows from above, RGBA) of spheres in a view (left, right, bottom, top) [m].

    position, depth, radius [m], colour (RGBA) of each. turned: direction of the x axis of each, whose half is darker; None: no rotation is shown.
    """
    left, right, bottom, top = view
    pixel = max(right - left, top - bottom) / SIDE
    high, wide = max(1, round((top - bottom) / pixel)), max(1, round((right - left) / pixel))
    image, nearest = np.zeros((high, wide, 4)), np.full((high, wide), -np.inf)
    x, y = left + pixel * (np.arange(wide) + 0.5), top - pixel * (np.arange(high) + 0.5)
    for k in np.argsort(-depth, kind="stable"):
        r = radius[k]
        columns = slice(*np.searchsorted(x, [position[k, 0] - r, position[k, 0] + r]))
        rows = slice(*np.searchsorted(-y, [-position[k, 1] - r, -position[k, 1] + r]))
        across, up = (x[columns] - position[k, 0])[None] / r, (y[rows] - position[k, 1])[:, None] / r
        square = 1 - across**2 - up**2
        towards = np.sqrt(np.maximum(square, 0))
        seen = (square > 0) & (depth[k] + r * towards > nearest[rows, columns])
        if not seen.any():
            continue
        bright = DARK + LIT * np.maximum(LIGHT[0] * across + LIGHT[1] * up + LIGHT[2] * towards, 0)
        if turned is not None:
            bright = np.where(turned[k, 0] * across + turned[k, 1] * up + turned[k, 2] * towards > 0, HALF * bright, bright)
        shaded = np.minimum(bright[..., None] * colour[k][:3], 1)
        image[rows, columns, :3][seen] = shaded[seen]
        image[rows, columns, 3][seen] = 1
        nearest[rows, columns][seen] = (depth[k] + r * towards)[seen]
    return image
