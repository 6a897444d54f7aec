"""A pyramid of equal disks on a row of fixed ones: its contact forces are not unique, but their sums over a row are.

`rows` disks lie at the bottom and one at the top, each in the gap between two; neighbours in a row touch. With friction there are more unknown
forces than equations. Every admissible set of forces carries, across each row, the weight above it without horizontal resultant, and its
resultant on the fixed row acts under the centre. The pyramid stands at any friction, even without, since each disk is held by two below. On a
flat floor forces that hold it exist only from mu = 0.27 on with two rows and 0.51 with six, and even then it may roll apart.
"""
from yade_scripts.parameter import Parameter
from yade_scripts.scenes import Chart, Known

TITLE = "Pyramid of disks"
KIND = "piles at rest"
HORIZON = ("Once the contacts carry the weights, for any time: CD's first step, MD after its normal springs have come to rest from touching "
           "without force.")
LEFT_OUT = "the single forces, which are not unique for rigid contacts: any admissible set of them is right"
DEFAULTS = dict(method="CD", radius_spread=0.0, friction=0.5, beta_n=0.5, gravity=9.81, period=0.2, records_per_cycle=10, tolerance=1e-12,
                max_iterations=10**6)
POSITIVE = ("gravity",)
PARAMETERS = (Parameter("rows", 5, "1", "number of rows that can move; the lowest of them has as many disks", low=1, high=100),)
CHART = Chart(rolling=True)


def build(full, folder):
    """Build the pyramid, symmetric about x = 0."""
    from yade import O
    from yade_scripts.running import stage
    ground = stage.Ground(full)
    radius, count = ground.radius, full["rows"]
    row_of, start = {}, {}
    for row in range(-1, count):
        for k in range(count - row):
            place = (2 * k - (count - row - 1)) * radius, row * 3**0.5 * radius
            disk = ground.disk(place, blocked="zXY" if row >= 0 else "xyzXYZ").id
            row_of[disk], start[disk] = row, place
    weight = ground.mass * full["gravity"]

    def across(row):
        """Return force (horizontal, vertical) and moment about x = 0 on `row` from the row below, over a disk's weight (and radius)."""
        horizontal = vertical = moment = 0.0
        for contact in O.interactions:
            if contact.isReal and {row_of[contact.id1], row_of[contact.id2]} == {row - 1, row}:
                # YADE's force acts on the second body.
                force = (contact.phys.normalForce + contact.phys.shearForce) / (weight if row_of[contact.id2] == row else -weight)
                horizontal, vertical = horizontal + force[0], vertical + force[1]
                moment += force[1] * contact.geom.contactPoint[0] / radius
        return horizontal, vertical, moment

    def worst_row():
        """Return the largest error of a row's resultant against the weight above it, over that weight."""
        above = [(count - row) * (count - row + 1) / 2 for row in range(count)]
        return max(max(abs(across(row)[0]), abs(across(row)[1] - carried)) / carried for row, carried in enumerate(above))

    def moved():
        return max((O.bodies[disk].state.pos[0] - x)**2 + (O.bodies[disk].state.pos[1] - y)**2 for disk, (x, y) in start.items())**0.5

    return stage.small(full, [
        Known("worst_row_error", "1", 0.0, worst_row, source="balance of everything above a row: its weight, no horizontal force"),
        Known("centre_of_pressure", "m", 0.0, lambda: across(0)[2] / across(0)[1] * radius, scale=radius,
              source="moment of the weights, which are symmetric"),
        Known("motion", "m", 0.0, moved, scale=radius, source="rigid disks do not give way")])
