"""Adding a study, a scene or a map is one new file each, found by its presence: tried in a copy of the repository."""
import os
import shutil
import subprocess
import sys

import pytest

SCENE = '''"""A disk falls freely for a while."""
from yade_scripts.scenes import Chart, Known

TITLE = "Free fall of a disk"
KIND = "falls"
METHODS = ("MD", "CD")
HORIZON = "Any time."
LEFT_OUT = "everything but gravity"
DEFAULTS = dict(method="CD", gravity=9.81, period=0.1, records_per_cycle=10)
PARAMETERS = ()
CHART = Chart(physics=("beta_n", "stiffening", "tolerance", "fixed_iterations", "accuracy"))


def build(full, folder):
    """One disk in empty space."""
    from yade import O

    from yade_scripts.running import bodies, stage
    radius, time = full["radius_mean"], full["period"] * full["cycles"]
    bodies.append_material("disk", full["friction"], full)
    state = O.bodies[bodies.append_disk((0, 0), radius, bodies.disk_mass(radius, full), "disk")].state
    return stage.small(full, [Known("speed", "m/s", -full["gravity"] * time, lambda: state.vel[1] * time / O.time, source="free fall")])
'''
STUDY = '''"""How fast a disk falls."""
from analysis import style
from analysis.style import plt
from yade_scripts.tables import product

TITLE = "A falling disk"
QUESTION = "How fast does it fall?"
ROWS = {"quick": product(scene="free_fall", method="CD", gravity=(1.0, 2.0)), "full": product(scene="free_fall", method=("MD", "CD"))}
ANSWER = "As fast as gravity says."


def summarize(runs):
    """One row a run."""
    return [{"gravity": run.parameters["gravity"], "speed": run.known["speed"].measured} for run in runs]


def draw(runs, rows, path):
    """Speed against gravity."""
    fig, axis = plt.subplots()
    axis.plot([row["gravity"] for row in rows], [row["speed"] for row in rows], "o")
    style.finish(fig, path, "The speed at the end.", runs)
'''
MAP = '''"""Where one is too large."""
from yade_scripts.measuring.maps import STABLE, UNSTABLE, Axis, Map, Outcome, Search, product


def grid(full):
    """Three by three."""
    return product(x=(1.0, 2.0, 4.0), y=(1.0, 2.0, 4.0))


def searches(full):
    """Along x."""
    return [Search({"y": 1.0}, "x", 1.0, 8.0, 1.1)]


MAP = Map(title="Too large", question="When is x too large?", criterion="x above 3.", remedy="Take less.",
          x=Axis("x", "x"), y=Axis("y", "y"), measures={"x": "itself"}, grid=grid, searches=searches)


def probe(case):
    """Compares."""
    return Outcome(UNSTABLE, "penetration", "", {"x": case["x"]}) if case["x"] > 3 else Outcome(STABLE, measures={"x": case["x"]})
'''


@pytest.fixture(scope="module")
def copy(root, tmp_path_factory):
    """The tracked files and the built engine, with one study, one scene and one map more."""
    target = tmp_path_factory.mktemp("copy")
    for name in subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=root, capture_output=True, text=True,
                               check=True).stdout.splitlines():
        if name.startswith(("analysis", "yade_scripts", "cd_engine", "README.md")) and (root / name).is_file():
            (target / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(root / name, target / name)
    for library in root.rglob("cd_engine/**/*.so"):
        shutil.copy(library, target / library.relative_to(root))
    (target / "yade_scripts/scenes/free_fall.py").write_text(SCENE)
    (target / "analysis/studies/falling.py").write_text(STUDY)
    (target / "yade_scripts/measuring/maps/too_large.py").write_text(MAP)
    return target


def run(copy, *arguments, status=0):
    done = subprocess.run([sys.executable, "-m", *arguments], cwd=copy, capture_output=True, text=True, timeout=1200,
                          env=os.environ | {"OMP_NUM_THREADS": "1"})
    assert done.returncode == status, done.stdout + done.stderr
    return done.stdout + done.stderr * (status != 0)


def test_a_new_study_scene_and_map_are_run_drawn_and_reported(copy):
    """By the commands behind `make study`, `make charts` and `make report`."""
    assert "falling.png" in run(copy, "analysis", "study", "--run", "--quick", "falling")
    assert run(copy, "yade_scripts.measuring", "--quick", "--only", "free_fall", "too_large").count(": measured") == 2
    said = run(copy, "analysis", "charts", "--quick")
    assert "map_too_large.png" in said and "work_precision-free_fall.png" in said
    run(copy, "analysis", "report", "--quick", "-o", "page.html")
    page = (copy / "page.html").read_text(encoding="utf-8")
    assert "A falling disk" in page and "As fast as gravity says." in page and "Too large" in page and ">free_fall</a>" in page
    assert "falls" in (copy / "figures/quick/charts/by_kind.csv").read_text()


def test_a_fault_in_a_scene_or_a_map_is_named_and_stops_no_other(copy):
    """After the test above, which leaves measurements."""
    faulty = {copy / "yade_scripts/scenes/bad.py": "TITLE = (", copy / "yade_scripts/measuring/maps/bad.py": "MAP = mpa"}
    for path, text in faulty.items():
        path.write_text(text)
    try:
        measured = run(copy, "yade_scripts.measuring", "--quick", "--only", "too_large", status=1)
        drawn = run(copy, "analysis", "charts", "--quick", status=2)
    finally:
        for path in faulty:
            path.unlink()
    assert "too_large: measured" in measured and "map_too_large.png" in drawn
    assert all(f"{path}" in said for path in faulty for said in (measured, drawn))


def test_make_runs_these_commands(root):
    said = {extent: subprocess.run(["make", "-n", "study", "charts", "report", "bench", "regression", *setting], cwd=root, capture_output=True,
                                   text=True,
                                   check=True).stdout for extent, setting in (("quick", []), ("full", ["FULL=1"]))}
    for words in ("analysis study --run", "yade_scripts.measuring", "analysis charts", "analysis report", "yade_scripts.measuring.benchmark"):
        for extent in ("quick", "full"):
            assert f"-m {words} --{extent}" in said[extent]
    assert "regression.py --full" in said["quick"]
