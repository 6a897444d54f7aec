"""Meshes of facets: contact as with the surface that they are, once each, whatever the triangulation."""
import math
import random

import numpy as np
import pytest
import yade
from yade import utils

import cd_engine
from yade_scripts.running.hooks import runner

from .test_space import G, ball, material, run, vector


def triangulated(random_seed, side=1.0, points=40):
    """Return triangles that cover a square: Delaunay's of random points, slivers among them, then some edges cut on one side only (T-junctions).
    Corners are those of each triangle by itself."""
    from scipy.spatial import Delaunay
    r = random.Random(random_seed)
    places = [(r.uniform(0, side), r.uniform(0, side)) for _ in range(points)]
    places += [(x + 1e-4 * r.random(), y + 1e-4 * r.random()) for x, y in places[:8]]  # slivers
    places += [(x, y) for x in (0, side) for y in (0, side)]
    places = np.array(places)
    triangles = [places[t] for t in Delaunay(places).simplices]
    for t in triangles[:len(triangles) // 3]:  # cut in two at a point of an edge; the neighbour is not
        k, share = r.randrange(3), r.uniform(0.2, 0.8)
        a, b, c = (t[(k + i) % 3] for i in range(3))
        middle = a + share * (b - a)
        triangles = [x for x in triangles if x is not t] + [np.array([a, middle, c]), np.array([middle, b, c])]
    return [[(*p, 0.0) for p in t] for t in triangles]


def mesh(triangles, mat, turn=None):
    """Append facets, each either way round."""
    r = random.Random(0)
    for t in triangles:
        t = [yade.Vector3(*p) for p in t]
        if turn is not None:
            t = [turn * p for p in t]
        if r.random() < 0.5:
            t = [t[0], t[2], t[1]]
        yade.O.bodies.append(utils.facet(t, material=mat))


@pytest.mark.parametrize("seed", range(3))
def test_a_sphere_rolls_over_any_triangulation_as_over_the_plane(O, seed):
    """With one contact a step, whose normal is that of the plane, which is tilted at will."""
    mat, radius = material(0.5), 0.03
    turn = yade.Quaternion(yade.Vector3(1, 2, 0.5).normalized(), 0.4)
    mesh(triangulated(seed), mat, turn)
    way = np.array([0.8, 0.61, 0]) / 2
    start = yade.Vector3(0.1, 0.15, radius)
    state = O.bodies[ball(turn * start, radius, mat, velocity=turn * yade.Vector3(*way),
                          spin=turn * yade.Vector3(*np.cross((0, 0, 1), way) / radius))].state
    down = turn * yade.Vector3(0, 0, -G)
    O.engines = cd_engine.engines(gravity=down, tolerance=1e-12)
    O.dt = 1e-3
    for _ in range(40):
        O.run(45, True)
        assert O.engines[2].contacts == 1
    assert vector(turn.conjugate() * state.vel) == pytest.approx(way, abs=1e-12)
    assert vector(turn.conjugate() * state.pos) == pytest.approx(vector(start) + 1.8 * way, abs=1e-12)


@pytest.mark.parametrize("facets", [40, 1000])
def test_a_sphere_rolls_over_the_corner_that_many_facets_share(O, facets):
    """A disc of slivers: as over the plane, with one contact a step, also while the sphere is near all of them."""
    mat, radius = material(0.5), 0.03
    rim = [(0.5 * math.cos(a), 0.5 * math.sin(a), 0) for a in np.arange(facets + 1) * 2 * math.pi / facets]
    O.bodies.append([utils.facet(((0, 0, 0), a, b), material=mat) for a, b in zip(rim, rim[1:])])
    way = np.array([0.8, 0.1, 0])
    state = O.bodies[ball((-0.08, -0.01, radius), radius, mat, velocity=way, spin=np.cross((0, 0, 1), way) / radius)].state
    O.engines = cd_engine.engines(gravity=(0, 0, -G), tolerance=1e-12)
    O.dt = 1e-3
    for _ in range(20):  # right over the corner in the middle
        O.run(10, True)
        assert O.engines[2].contacts == 1
    assert vector(state.vel) == pytest.approx(way, abs=1e-12)


@pytest.mark.parametrize("at", ["edge", "corner"])
def test_rest_on_an_inner_edge_or_corner_is_one_force(O, at):
    mat, radius = material(0.5), 0.03
    mesh([[(0, 0, 0), (math.cos(t), math.sin(t), 0), (math.cos(t + 1), math.sin(t + 1), 0)] for t in np.arange(6) * 1.0]
         + [[(0, 0, 0), (math.cos(6), math.sin(6), 0), (1, 0, 0)]], mat)
    sphere = ball((0, 0, radius) if at == "corner" else (0.5 * math.cos(1), 0.5 * math.sin(1), radius), radius, mat)
    engine = run(50, 1e-3)
    assert engine.contacts == 1 and vector(O.bodies[sphere].state.vel) == pytest.approx((0, 0, 0), abs=1e-14)
    loaded = [i for i in O.interactions if i.isReal]
    assert len(loaded) == 1 and loaded[0].phys.normalForce[2] == pytest.approx(G * O.bodies[sphere].state.mass, rel=1e-12)


@pytest.mark.parametrize("mu", [0.5, 0])
@pytest.mark.parametrize("theta", [0.3, 0.8])
def test_valley(O, mu, theta):
    """A sphere rolls down one face and meets the next, turned up by theta, without a rebound: v'/v = (2 + 5 cos theta)/7 where it rolls, cos theta
    without friction. Its angular momentum about the new contact line is kept; the faces carry, the edge between them is concave."""
    mat, radius = material(mu), 0.1
    up = np.array([math.cos(theta), 0, math.sin(theta)])
    floor, slope = [(-1, -1, 0), (0, -1, 0), (0, 1, 0), (-1, 1, 0)], [(0, -1, 0), (*up - [0, 1, 0],), (*up + [0, 1, 0],), (0, 1, 0)]
    mesh([[q[0], q[1], q[2]] for q in (floor, slope)] + [[q[0], q[2], q[3]] for q in (floor, slope)], mat)
    reach = radius * math.tan(theta / 2)  # from the edge to the contact when both faces are touched
    v = 1.0
    state = O.bodies[ball((-reach - 0.0505, 0.1, radius), radius, mat, velocity=(v, 0, 0), spin=(0, v / radius if mu else 0, 0))].state
    run(80, 1e-3, gravity=(0, 0, 0), tolerance=1e-13)
    after = v * ((2 + 5 * math.cos(theta)) / 7 if mu else math.cos(theta))
    assert vector(state.vel) == pytest.approx(after * up, abs=1e-9)
    assert state.angVel[1] == pytest.approx(after / radius if mu else 0, abs=1e-8)


def test_a_convex_edge_holds_and_lets_go(O):
    """A ball that slips off a sharp edge without friction leaves it where cos phi = 2/3, from rest at the top."""
    mat, radius = material(0), 0.1
    mesh([[(-1, -1, 0), (0, -1, 0), (0, 1, 0)], [(-1, -1, 0), (0, 1, 0), (-1, 1, 0)], [(0, -1, 0), (0, 1, 0), (0, 1, -1)],
          [(0, -1, 0), (0, 1, -1), (0, -1, -1)]], mat)
    state = O.bodies[ball((radius * math.sin(0.01), 0.2, radius * math.cos(0.01)), radius, mat)].state
    O.engines = cd_engine.engines(gravity=(0, 0, -G), tolerance=1e-12)
    O.dt = 1e-4
    while True:
        O.run(1, True)
        if O.engines[2].loadedContacts == 0 or O.iter > 20000:
            break
    # From phi0 = 0.01: cos phi = 2/3 cos phi0.
    assert state.pos[2] / math.hypot(state.pos[0], state.pos[2]) == pytest.approx(2 / 3 * math.cos(0.01), abs=1e-3)


def test_facets_are_two_sided(O):
    mat = material(0)
    mesh([[(-1, -1, 0), (1, -1, 0), (0, 1, 0)]], mat)
    above, below = ball((0, 0, 0.3), 0.1, mat, velocity=(0, 0, -1)), ball((0, 0, -0.3), 0.1, mat, velocity=(0, 0, 1))
    run(400, 1e-3, gravity=(0, 0, 0), restitution=1)
    assert O.bodies[above].state.vel[2] == pytest.approx(1) and O.bodies[below].state.vel[2] == pytest.approx(-1)


@pytest.mark.parametrize("theta", [0.05, 0.2, 0.4, 0.8])
@pytest.mark.parametrize("share", [0.1, 0.3, 0.8])
@pytest.mark.parametrize("phase", [0.1, 0.45, 0.8])
def test_a_valley_at_long_steps(O, theta, share, phase):
    """A step may move the sphere past the place where the foot of its centre first falls on the next face, R (tan t - tan(t/2)) before it touches it:
    0.025 radii at 0.05. It does not sink in, and goes on along this face."""
    mat, radius = material(0), 0.1
    up = np.array([math.cos(theta), 0, math.sin(theta)])
    floor, slope = [(-1, -1, 0), (0, -1, 0), (0, 1, 0), (-1, 1, 0)], [(0, -1, 0), (*up - [0, 1, 0],), (*up + [0, 1, 0],), (0, 1, 0)]
    mesh([[q[0], q[1], q[2]] for q in (floor, slope)] + [[q[0], q[2], q[3]] for q in (floor, slope)], mat)
    way = share * radius
    state = O.bodies[ball((-radius * math.tan(theta / 2) - (5 + phase) * way, 0.13, radius), radius, mat, velocity=(1, 0, 0))].state
    engine = run(12, way, gravity=(0, 0, 0), tolerance=1e-13)
    assert engine.deepestPenetration < 1e-12 * radius
    assert vector(state.vel) == pytest.approx(state.vel.norm() * up, abs=1e-12)
    assert vector(state.pos) @ [-up[2], 0, up[0]] >= radius * (1 - 1e-12)


@pytest.mark.parametrize("gap", [0.6, 1.2])
@pytest.mark.parametrize("share", [0.1, 0.3, 0.8])
def test_nothing_stands_beyond_the_end_of_a_wall_on_a_floor(O, gap, share):
    """A sphere rolls past the ends of a wall and of a kerb, each around a concave edge from the floor: it touches the floor only."""
    mat, radius = material(0.5), 0.1
    floor = [(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)]
    wall, kerb = [(0, 0, 0), (0, 2, 0), (0, 2, 1), (0, 0, 1)], [(0.4, 0, 0), (0.4, 2, 0), (0.5, 2, 0.03), (0.5, 0, 0.03)]
    mesh([[q[0], q[1], q[2]] for q in (floor, wall, kerb)] + [[q[0], q[2], q[3]] for q in (floor, wall, kerb)], mat)
    state = O.bodies[ball((-0.5, -(1 + gap) * radius, radius), radius, mat, velocity=(1, 0, 0), spin=(0, 1 / radius, 0))].state
    run(round(1.2 / (share * radius)), share * radius)
    assert vector(state.vel) == pytest.approx((1, 0, 0), abs=1e-12) and state.pos[2] == pytest.approx(radius, abs=1e-13)


@pytest.mark.parametrize("seed", range(2))
def test_springs_go_on_from_facet_to_facet(O, seed):
    """A sphere with contact stiffnesses slides and rolls down a triangulated slope as down a Wall: its tangential spring stays when it passes an
    inner edge. The paths differ by the round-off of the normals."""
    def path(of_facets):
        O.reset()
        mat, radius = material(0.5), 0.03
        mesh(triangulated(seed), mat) if of_facets else O.bodies.append(utils.wall(0, axis=2, material=mat))
        stiffness = 4 / 3 * math.pi * radius**3 * 1000 * G / (0.02 * radius)  # its weight compresses the spring by 2 % of the radius
        state = O.bodies[ball((0.1, 0.15, 0.98 * radius), radius, mat)].state
        O.engines = cd_engine.engines(gravity=(0.2 * G, 0.15 * G, -G), stiffness=stiffness, tangentialStiffness=0.5 * stiffness)
        O.dt = 1e-3
        O.run(700, True)
        return [*state.pos, *state.vel, *state.angVel]

    on_facets, on_wall = path(True), path(False)
    assert on_wall[0] > 0.3 and on_facets == pytest.approx(on_wall, abs=1e-11)


def test_a_spring_on_an_inner_edge_holds_a_shaken_sphere(O):
    """It sticks on a slope, and small pushes move it to and fro over the edge between two facets: it stays, as on one facet."""
    def place(triangles):
        O.reset()
        mat, radius, angle = material(0.5), 0.1, 0.3
        mesh(triangles, mat)
        weight = 4 / 3 * math.pi * radius**3 * 1000 * G
        stiffness = weight / (1e-3 * radius)
        sag = weight * math.sin(angle) / (0.5 * stiffness)
        body = ball((-sag, 0, radius - weight * math.cos(angle) / stiffness), radius, mat)
        O.bodies[body].state.blockedDOFs = "XYZ"
        shake = runner(lambda: O.forces.addF(body, (0.1 * weight * math.sin(40 * math.pi * O.time), 0, 0)))
        reset, collider, engine = cd_engine.engines(gravity=(G * math.sin(angle), 0, -G * math.cos(angle)), stiffness=stiffness,
                                                    tangentialStiffness=0.5 * stiffness)
        O.engines, O.dt = [reset, collider, shake, engine], 1e-3
        O.run(1000, True)
        return O.bodies[body].state.pos[0]

    one = place([[(-9, -9, 0), (9, -9, 0), (0, 9, 0)]])
    assert place([[(0, -2, 0), (0, 2, 0), (-2, 0, 0)], [(0, -2, 0), (0, 2, 0), (2, 0, 0)]]) == pytest.approx(one, rel=1e-9)
