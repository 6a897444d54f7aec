"""How one looks at a scene in space: the axes of the picture, and the faces of the boundaries."""
import numpy as np

LOOK = 0.35, 1.0, -0.35  # right-handed, z upwards: along y, a little from the left and from above
BESIDE = 0.1  # how far a Wall is drawn beyond the spheres, in parts of their larger side


def upwards(O):
    """Return the unit vector against gravity; along z without any."""
    for engine in O.engines:
        gravity = np.array([*getattr(engine, "gravity", (0, 0, 0))])
        if gravity.any():
            return -gravity / np.linalg.norm(gravity)
    return np.array([0.0, 0, 1])


def axes(look, up):
    """Return the directions to the right, upwards and towards the viewer as the rows of a matrix. look: that of the sight, with `up` as its third
    direction; if nothing of `up` is seen, the picture's upper side is along the next axis of space."""
    look, up = np.asarray(look, float), np.asarray(up, float)
    towards = -look / np.linalg.norm(look)
    right = np.cross(up, towards)
    if np.linalg.norm(right) < 1e-6:
        right = np.cross(np.roll(up, 2), towards)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(towards, right), towards])


def faces(O, place, radius):
    """Return the corners [m] of the faces of all boundaries. place, radius [m]: of the spheres, beside which a Wall is drawn."""
    low, high = (place - radius[:, None]).min(axis=0), (place + radius[:, None]).max(axis=0)
    room = BESIDE * (high - low).max()
    found = []
    for body in O.bodies:
        kind, state = type(body.shape).__name__, body.state
        if kind == "Facet":
            found.append(np.array([[*(state.pos + state.ori * corner)] for corner in body.shape.vertices]))
        elif kind == "Box":
            turn = np.array([[state.ori.toRotationMatrix()[row, column] for column in range(3)] for row in range(3)])
            found += [np.array([*state.pos]) + (face * [*body.shape.extents]) @ turn.T for face in CUBE]
        elif kind == "Wall":
            one, other = (axis for axis in range(3) if axis != body.shape.axis)
            corners = np.empty((4, 3))
            corners[:, body.shape.axis] = state.pos[body.shape.axis]
            corners[:, one] = np.array([low, high, high, low])[:, one] + room * np.array([-1, 1, 1, -1])
            corners[:, other] = np.array([low, low, high, high])[:, other] + room * np.array([-1, -1, 1, 1])
            found.append(corners)
    return found


def _cube():
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    return [np.insert(square, axis, side, axis=1) for axis in range(3) for side in (-1, 1)]


CUBE = _cube()
