"""cd_engine.picture and cd_engine.film: what they draw of known scenes, and what they refuse."""
import os
import re

import numpy as np
import pytest
from PIL import Image
from yade import Quaternion, utils

import cd_engine
from cd_engine.pictures import drawing, layout, scene

from . import plane, programs

G, WEIGHT = 9.81, 9.81  # m/s^2, N of the disks of 1 kg


def figure(**options):
    seen = scene.read()
    view = drawing.bounds(seen.position, seen.radius, seen.boxes, seen.walls)
    return layout.figure(seen, layout.shape_of(view, 5), view, **options)


def drawn(fig):
    """The collections of the axes by kind and number of elements, in the order in which they are drawn."""
    return {(type(one).__name__, max(len(one.get_paths()), len(one.get_offsets()))): one for one in fig.axes[0].collections if len(one.get_paths())}


def widths_of(disks):
    """Their diameters [m], which matplotlib 3.6 only keeps by half and for itself."""
    return np.ravel(disks.get_widths() if hasattr(disks, "get_widths") else 2 * disks._widths)


@pytest.fixture(params=["rigid", "springs"])
def stack(request, O):
    """Two disks of radius 1 m, one on the other, at rest on a wall: 2 m g below, m g between them. A fixed box beside, turned by 30 degrees."""
    mat = plane.ground()
    plane.disk((0, 1), 1, mat=mat)
    plane.disk((0, 3), 1, mat=mat)
    plane.box((3, 1), (1, 0.2), angle=np.pi / 6)
    if request.param == "rigid":
        plane.run(200, 1e-3, gravity=(0, -G, 0), tolerance=1e-10)
    else:
        O.engines, O.dt = plane.springs(damping=0.7), 2e-4
        O.run(20000, True)
    return O


def test_what_is_drawn_of_two_disks(stack):
    seen = scene.read()
    assert seen.names == ("x", "y") and seen.walls == [(1, 0)] and seen.position == pytest.approx(np.array([[0, 1], [0, 3]]), abs=1e-3)
    assert sorted(seen.link_force) == pytest.approx([WEIGHT, 2 * WEIGHT], rel=1e-3)
    ends = {tuple(np.round(sorted(link[:, 1]), 2)) for link in seen.links}
    assert ends == {(0, 1), (1, 3)} and seen.links[:, :, 0] == pytest.approx(0, abs=1e-9)
    assert seen.force[np.argsort(seen.position[:, 1])] == pytest.approx([3 * WEIGHT, WEIGHT], rel=1e-3)
    corners = {tuple(np.round(corner, 6)) for corner in np.array(seen.boxes).reshape(-1, 2)}
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    assert corners == {tuple(np.round((3 + a * c - 0.2 * b * s, 1 + a * s + 0.2 * b * c), 6)) for a in (-1, 1) for b in (-1, 1)}


def test_force_is_width_and_colour(stack):
    fig = figure()
    fig.canvas.draw()
    shown = drawn(fig)
    disks, chains = shown["EllipseCollection", 2], [one for one in fig.axes[0].collections if one.get_cmap() is drawing.FORCES][0]
    assert disks.get_offsets() == pytest.approx(scene.read().position) and len(set(widths_of(disks))) == 1 and widths_of(disks)[0] == 2
    assert sorted(chains.get_array()) == pytest.approx([WEIGHT, 2 * WEIGHT], rel=1e-3)
    widths = [np.ptp(path.vertices[:, 0]) for path in chains.get_paths()]  # the forces are vertical
    assert widths[1] == pytest.approx(2 * widths[0], rel=1e-3)
    light, dark = (colour[:3].sum() for colour in chains.get_facecolor())
    assert light > dark + 0.5
    assert [axes.get_ylabel() for axes in fig.axes] == ["y [m]", "speed [m/s]", "normal force of a contact [N]"]
    assert fig.axes[0].get_xlabel() == "x [m]" and re.fullmatch(r"t = [\d.]+ s", fig.axes[0].get_title("left"))


def test_what_disks_are_coloured_by(O):
    for k in range(3):
        plane.disk((3 * k, 0), 0.5 + 0.1 * k, velocity=(3 * k, 4 * k), spin=k - 1)
    plane.disk((9, 0), 0.5, blocked="xyzXYZ")
    for colour, values, limits in (("speed", [0, 5, 10], (0, 10)), ("force", [0, 0, 0], (0, 1)), ("radius", [0.5, 0.6, 0.7], (0.5, 0.7)),
                                   ("spin", [-1, 0, 1], (-1, 1)), ([7, 8, 9, 1], [7, 8, 9], (7, 9)), ([-1, 0, 4, 1], [-1, 0, 4], (-4, 4))):
        disks = drawn(figure(colour=colour))["EllipseCollection", 4]
        shown = disks.get_array()
        assert shown[:3].tolist() == pytest.approx(values) and shown.mask.tolist() == [False] * 3 + [True]  # a fixed one is grey
        assert disks.get_clim() == pytest.approx(limits)
    assert drawn(figure(colour=None, rotation=False)).keys() == {("EllipseCollection", 4)}
    assert drawn(figure(limits=(0, 2)))["EllipseCollection", 4].get_clim() == (0, 2)


def test_a_packing_at_rest_looks_at_rest(O):
    """The rounding errors of its speeds are not coloured."""
    plane.disk((0, 0), 1, velocity=(1e-12, 0))
    assert drawn(figure())["EllipseCollection", 1].get_clim() == (0, 1)


@pytest.mark.parametrize("normal, names, blocked", [(2, ("x", "y"), "zXY"), (1, ("x", "z"), "yXZ"), (0, ("y", "z"), "xYZ")])
def test_the_plane_is_that_of_the_freedoms(O, normal, names, blocked):
    """A disk turned from the first towards the second axis of the picture is shown so, and a box and a wall in their places."""
    first, second = scene.PLANES[normal]
    one, other, axis = np.eye(3)[first], np.eye(3)[second], np.cross(np.eye(3)[first], np.eye(3)[second])
    for place in (one + 0.5 * other, 3 * other):
        body = utils.sphere(tuple(place), 0.5)
        body.state.blockedDOFs = blocked
        body.state.angVel = tuple(2 * axis)
        body.state.ori = Quaternion(tuple(axis), 0.7)
        O.bodies.append(body)
    O.bodies.append(utils.wall(-1, axis=second))
    O.bodies.append(utils.wall(0, axis=normal))  # the plane itself
    O.bodies.append(utils.box(tuple(-one), tuple(0.1 + 0.2 * one + 0.3 * other), fixed=True))
    O.bodies.append(utils.box(tuple(2 * axis), (1, 1, 1), fixed=True))  # in front of the plane
    seen = scene.read()
    assert seen.names == names and seen.walls == [(1, -1)]
    assert seen.position == pytest.approx(np.array([[1, 0.5], [0, 3]])) and seen.angle == pytest.approx(0.7) and seen.spin == pytest.approx(2)
    (corners,) = seen.boxes
    assert np.ptp(corners, axis=0) == pytest.approx([0.6, 0.8]) and corners.mean(axis=0) == pytest.approx([-1, 0])


def test_a_contact_across_the_border_of_a_periodic_cell(O):
    """It is as long as the disks are apart, and they are drawn in the cell."""
    O.periodic = True
    O.cell.setBox(1, 1, 1)
    for x in (0.1, 1.95):
        body = utils.sphere((x, 0.5, 0.5), 0.12)
        body.state.blockedDOFs = "zXY"
        O.bodies.append(body)
    O.engines, O.dt = plane.springs(), 1e-6
    O.step()
    seen = scene.read()
    assert seen.position[:, 0] == pytest.approx([0.1, 0.95], abs=1e-3)
    (link,) = seen.links
    assert abs(np.diff(link[:, 0])) == pytest.approx(0.15, abs=1e-3) and np.diff(link[:, 1]) == pytest.approx(0, abs=1e-6)


def test_links_of_a_snapshot():
    """Ids of a result file: bodies 5 and 7 are disks, 2 is a wall."""
    links = drawing.links([[0, 0], [2, 0]], np.array([7, 5]), np.array([[5, 7], [2, 7]]), np.array([[1, 0], [0, -1]]))
    assert links.tolist() == [[[2, 0], [0, 0]], [[0, -1], [0, 0]]]


def test_the_view_holds_the_disks_and_what_is_near():
    position, radius = np.array([[0.0, 0], [10, 0], [0, 10]]), np.ones(3)
    small, tall, far = ([[x, y], [x, y + high], [x + 1, y + high], [x + 1, y]] for x, y, high in ((12, 0, 3), (12, 0, 1000), (30, 0, 1)))
    near = drawing.bounds(position, radius, [small])
    assert near[1] > 13 > drawing.bounds(position, radius, [far])[1] and drawing.bounds(position, radius, [tall])[3] < 13
    assert drawing.bounds(position, radius, walls=[(1, -3)])[2] < -3 < drawing.bounds(position, radius, walls=[(1, -300)])[2]


def test_files_of_every_format(stack, tmp_path):
    for ending, begin in ((".png", b"\x89PNG"), (".pdf", b"%PDF"), (".svg", b"<?xml")):
        cd_engine.picture(tmp_path / f"a{ending}")
        assert (tmp_path / f"a{ending}").read_bytes().startswith(begin)
    with Image.open(tmp_path / "a.png") as image:
        assert len(set(image.convert("RGB").getdata())) > 20


@pytest.mark.parametrize("arguments, says", [
    (dict(path="a.jpg"), "'a.jpg' must end in .png, .pdf or .svg"), (dict(path="none/a.png"), "there is no folder 'none' for 'none/a.png'"),
    (dict(colour="hue"), "colour='hue' must be one of 'speed', 'force', 'radius', 'spin', None or an array"),
    (dict(colour=[1, 2, 3]), r"colour has the shape \(3,\), but there are 1 disks"), (dict(limits=(1, 0)), r"limits=\(1, 0\) must be \(low, high\)"),
    (dict(view=(0, 1)), r"view=\(0, 1\) must be \(left, right, bottom, top\)"), (dict(size=0), "size=0 must be a number above 0"),
    (dict(strongest="big"), "strongest='big' must be a number above 0"), (dict(look=(0, 0, 0)), r"look=\(0, 0, 0\) must be a direction")])
def test_arguments_that_cannot_be(O, tmp_path, monkeypatch, arguments, says):
    monkeypatch.chdir(tmp_path)
    plane.disk((0, 0), 1)
    with pytest.raises((ValueError, FileNotFoundError), match=says):
        cd_engine.picture(**dict(path="a.png") | arguments)
    assert not os.listdir()


def test_scenes_that_cannot_be_drawn(O, tmp_path):
    with pytest.raises(ValueError, match="there is no disk in the scene"):
        cd_engine.picture(tmp_path / "a.png")


def in_space(O):
    """Append four spheres of radius 0.4 m, two of them behind each other for who looks along x."""
    O.bodies.append([utils.sphere(place, 0.4) for place in ((0, 0, 0), (2, 0, 0.3), (0, 1, 0), (0, 0, 1.2))])


def test_spheres_are_seen_along_the_look(O):
    """Along x, y is to the left and x away. Of two spheres behind each other one sees the nearer, and of each sphere its whole circle."""
    in_space(O)
    seen = scene.read((1, 0, 0))
    assert seen.names == ("right", "up") and seen.position == pytest.approx(np.array([[0, 0], [0, 0.3], [-1, 0], [0, 1.2]]), abs=1e-12)
    assert seen.depth == pytest.approx(np.array([0, -2, 0, 0]), abs=1e-12)
    (drawn,) = layout.figure(seen, (4, 3), (-2, 2, -1, 2), colour=[0, 1, 2, 3], rotation=False).axes[0].images
    image = np.asarray(drawn.get_array(), float)[::-1]
    assert drawn.get_extent() == pytest.approx([-2, 2, -1, 2])
    at = [[image[int((y + 1) * image.shape[0] / 3), int((x + 2) * image.shape[1] / 4)] for x, y in places] for places in (
        [(0, 0), (0, 0.36), (0, 0.6), (-1, 0.1), (0, 1.3)], [(-1 + 0.39 * np.cos(t), 0.39 * np.sin(t)) for t in range(6)],
        [(-1 + 0.41 * np.cos(t), 0.41 * np.sin(t)) for t in range(6)])]
    for pixel, sphere in zip(at[0], (0, 0, 1, 2, 3)):  # light changes the brightness, not the hue
        hue = np.array(drawing.DISKS(sphere / 3)[:3])
        assert pixel[:3] / pixel[:3].max() == pytest.approx(hue / hue.max(), abs=0.02)
    assert [pixel[3] for pixel in at[1]] == [1] * 6 and [pixel[3] for pixel in at[2]] == [0] * 6


def test_half_of_a_sphere_shows_how_it_is_turned(O):
    in_space(O)
    O.bodies[0].state.ori = Quaternion((0, 1, 0), 0.5)  # which turns its own x axis downwards
    turned = scene.read((0, 1, 0)).turned
    assert turned[0] == pytest.approx([np.cos(0.5), -np.sin(0.5), 0]) and turned[1] == pytest.approx([1, 0, 0])


def test_up_is_against_gravity_and_boundaries_have_faces(O):
    """The faces of a facet, of a box, and of a wall that is cut off beside the spheres."""
    in_space(O)
    O.bodies.append(utils.facet([(0, 0, 0), (1, 0, 0), (0, 2, 0)]))
    O.bodies.append(utils.box((5, 0, 0), (0.1, 0.2, 0.3), orientation=Quaternion((0, 0, 1), np.pi / 2), fixed=True))
    O.bodies.append(utils.wall(-1, axis=1))
    O.engines = plane.springs(gravity=(0, -G, 0))
    seen = scene.read((0, 0, -1))
    assert seen.position == pytest.approx(np.array([[0, 0], [2, 0], [0, 1], [0, 0]]), abs=1e-12) and len(seen.boxes) == 8
    assert seen.boxes[0] == pytest.approx(np.array([[0, 0], [1, 0], [0, 2]]), abs=1e-12)
    assert np.ptp(np.concatenate(seen.boxes[1:7]), axis=0) == pytest.approx([0.4, 0.2])
    assert np.ptp(seen.boxes[7][:, 0]) == pytest.approx(2.8 + 0.2 * 2.8) and seen.boxes[7][:, 1] == pytest.approx(-1)


def test_a_picture_and_a_film_in_space(O, tmp_path):
    """Speeds count all three directions. Force lines are drawn only if asked for."""
    in_space(O)
    O.bodies[0].state.vel, O.bodies[0].state.angVel = (0, 3, 4), (0, 2, 0)
    O.engines, O.dt = plane.springs(gravity=(0, 0, 0)) + [cd_engine.film(tmp_path / "a.gif", every=0.01, size=2.6, dpi=60, look=(0, 1, 0))], 0.01
    seen = scene.read((0, 1, 0))
    assert layout.coloured(seen, "speed")[1][0] == pytest.approx(5) and layout.coloured(seen, "spin")[1][0] == pytest.approx(-2)
    O.run(4, True)
    cd_engine.picture(tmp_path / "a.png")
    assert len(frames(tmp_path / "a.gif")) >= 3 and len({frame.tobytes() for frame in frames(tmp_path / "a.gif")}) >= 3
    with Image.open(tmp_path / "a.png") as image:
        assert len(set(image.convert("RGB").getdata())) > 20


def test_nothing_of_the_users_pyplot_changes(tmp_path):
    """No screen, no backend chosen: a figure of the user's and its look stay, and pyplot is not even imported for a picture."""
    program = """
import yade, cd_engine
from yade import O, utils
{first}
O.bodies.append(utils.sphere((0, 0, 0), 1))
cd_engine.picture("a.png")
print({asked})
"""
    environment = dict(DISPLAY="", HOME=os.environ.get("HOME", "/tmp"))
    for first, asked, said in (("", "'matplotlib.pyplot' in sys.modules", "False"),
                               ("import matplotlib; matplotlib.use('svg'); import matplotlib.pyplot as p; p.figure(7); r = dict(matplotlib.rcParams)",
                                "matplotlib.get_backend(), p.get_fignums(), dict(matplotlib.rcParams) == r, p.gcf().axes", "svg [7] True []")):
        text = f"import os, sys; os.chdir({str(tmp_path)!r})\n" + program.format(first=first, asked=asked)
        done = programs.in_python(text.replace("import yade, cd_engine", "before = 'matplotlib.pyplot' in sys.modules\nimport yade, cd_engine"),
                                  **environment)
        assert done.stdout.split("\n")[-2] == said, done.stdout + done.stderr


def frames(path):
    """The frames of a GIF as arrays."""
    with Image.open(path) as film:
        return [np.asarray(film.convert("RGB")) for number in range(film.n_frames) if film.seek(number) is None]


def sliding(O, **options):
    """A disk that moves to the right at 1 m/s, filmed each 0.1 s at steps of 0.01 s; the engines are those of springs."""
    plane.disk((0, 0), 0.1, velocity=(1, 0))
    O.engines, O.dt = plane.springs(gravity=(0, 0, 0), damping=0) + [cd_engine.film(every=0.0999, size=2.6, dpi=60, **options)], 0.01


def test_a_film_has_a_frame_for_each_period(O, tmp_path):
    sliding(O, path=tmp_path / "a.gif", view=(-1, 3, -1, 1))
    O.run(101, True)
    shown = frames(tmp_path / "a.gif")
    assert len(shown) == 11 and len({frame.tobytes() for frame in shown}) == 11
    with Image.open(tmp_path / "a.gif") as film:
        assert film.info["duration"] == 100 and film.info["loop"] == 0  # [ms]: real time
    blue = [np.flatnonzero((frame[60:110, 50:210, 2] > frame[60:110, 50:210, 0] + 40.0).any(axis=0)).mean() for frame in shown]
    assert np.diff(blue) == pytest.approx(np.diff(blue).mean(), abs=2) and np.diff(blue).mean() == pytest.approx(0.1 / 4 * 2.6 * 60, abs=0.5)


def test_a_film_of_a_scene_that_runs_empty(O, tmp_path):
    """No frame is made before the first disk is there, nor after the last one has gone."""
    plane.floor()
    O.engines, O.dt = plane.springs(gravity=(0, 0, 0)) + [cd_engine.film(path=tmp_path / "a.gif", every=0.0999, size=2, dpi=50)], 0.01
    O.run(15, True)
    disk = plane.disk((0, 0.2), 0.1)
    O.run(30, True)
    O.bodies.erase(disk)
    O.run(30, True)
    assert len(frames(tmp_path / "a.gif")) == 3


def test_a_frame_is_what_the_picture_shows(O, tmp_path):
    """Colours and places survive the format."""
    sliding(O, path=tmp_path / "a.gif", view=(-1, 3, -1, 1), limits=(0, 1))
    O.run(1, True)
    cd_engine.picture(tmp_path / "a.png", view=(-1, 3, -1, 1), limits=(0, 1), size=2.6, dpi=60, title="t = 0 s")
    with Image.open(tmp_path / "a.png") as picture:
        other = np.asarray(picture.convert("RGB"))
    (frame,) = frames(tmp_path / "a.gif")
    assert frame.shape == other.shape and np.abs(frame - other.astype(float)).mean() < 4


def test_a_film_follows_a_scene_that_is_loaded_again(O, tmp_path):
    """Frames of times that the scene has not reached are cut, here and in another process; a new run of the script begins anew."""
    film, saved = tmp_path / "a.gif", str(tmp_path / "a.yade.gz")
    sliding(O, path=film)
    O.run(51, True)
    O.save(saved)
    O.run(50, True)
    first = frames(film)
    assert len(first) == 11
    O.load(saved)
    O.run(20, True)
    assert len(frames(film)) == 8 and all((one == other).all() for one, other in zip(frames(film)[:6], first))
    done = programs.in_python(f"import cd_engine\nfrom yade import O\nO.load({saved!r})\nO.run(30, True)")
    again = frames(film)
    assert len(again) == 9 and all((one == other).all() for one, other in zip(again[:6], first)), done.stderr
    assert len({frame.tobytes() for frame in again}) == 9
    O.reset()
    sliding(O, path=film)
    O.run(1, True)
    assert len(frames(film)) == 1


def test_a_film_that_was_cut_in_a_frame_goes_on(O, tmp_path):
    """As where the process was killed while it wrote."""
    sliding(O, path=tmp_path / "a.gif")
    O.run(21, True)
    os.truncate(tmp_path / "a.gif", (tmp_path / "a.gif").stat().st_size - 100)
    O.run(10, True)
    assert len(frames(tmp_path / "a.gif")) == 3


def test_two_films_and_numbered_pictures_at_once(O, tmp_path):
    (tmp_path / "b-00002.png").write_text("of a longer run before")
    sliding(O, path=tmp_path / "a.gif")
    O.engines = O.engines + [cd_engine.film(tmp_path / "b.png", every=0.1999, size=2.6, dpi=60, colour=None)]
    O.run(31, True)
    assert len(frames(tmp_path / "a.gif")) == 4
    assert sorted(path.name for path in tmp_path.glob("b-*")) == ["b-00000.png", "b-00001.png"]


def test_the_view_of_a_film_grows(O, tmp_path):
    """It never shrinks, and the frames keep their size."""
    sliding(O, path=tmp_path / "a.gif")
    views = []
    for _ in range(3):
        O.run(150, True)
        views.append(eval(O.engines[-1].command.split("frame(")[1][:-1])[2]["view"])
    for earlier, later in zip(views, views[1:]):
        assert later[0] <= earlier[0] and later[1] >= earlier[1]
    assert views[-1][1] > 4.4 and len({frame.shape for frame in frames(tmp_path / "a.gif")}) == 1


def test_a_film_is_complete_when_the_run_is_killed(tmp_path):
    programs.in_python(f"""
import os, cd_engine
from yade import O, utils
O.bodies.append(utils.sphere((0, 0, 0), 1))
O.engines, O.dt = [cd_engine.film({str(tmp_path / "a.gif")!r}, every=1e-9)], 1e-3
O.run(5, True)
os.kill(os.getpid(), 9)""")
    assert len(frames(tmp_path / "a.gif")) == 5


def test_an_mp4_is_what_ffmpeg_is_given(O, tmp_path, monkeypatch):
    """A stand-in for ffmpeg keeps the frames; without any the film is refused."""
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ValueError, match="needs the program ffmpeg, which is not installed"):
        cd_engine.film(tmp_path / "a.mp4", every=1)
    (tmp_path / "ffmpeg").write_text('#!/bin/sh\nfor last; do :; done\necho "$@" > "$last.arguments"\nexec /bin/cat > "$last"\n')
    (tmp_path / "ffmpeg").chmod(0o755)
    sliding(O, path=tmp_path / "a.mp4")
    O.run(31, True)
    from cd_engine.pictures import frames as module
    module._finish(str(tmp_path / "a.mp4"))
    width, height = map(int, re.search(r"-s (\d+)x(\d+)", (tmp_path / "a.mp4.arguments").read_text()).groups())
    assert (tmp_path / "a.mp4").stat().st_size == 4 * 4 * width * height


@pytest.mark.parametrize("arguments, says", [
    (dict(path="a.avi"), "must end in .gif, .mp4 or .png"), (dict(every=0), "every=0 must be a number above 0"), (dict(fps=-1), "fps=-1 must be"),
    (dict(colour=[1]), "colour must be one of"), (dict(path="none/a.gif"), "there is no folder")])
def test_films_that_cannot_be(arguments, says):
    with pytest.raises((ValueError, FileNotFoundError), match=says):
        cd_engine.film(**dict(path="a.gif", every=1) | arguments)


def test_a_picture_during_a_run_is_refused(O, tmp_path):
    plane.disk((0, 0), 1)
    O.engines, O.dt = plane.springs(), 1e-6
    O.run()
    try:
        with pytest.raises(RuntimeError, match="a run goes on"):
            cd_engine.picture(tmp_path / "a.png")
    finally:
        O.pause()
