"""ContactDynamics is an engine of YADE's like any other."""
import copy
import pickle
import pydoc
import re
import subprocess
import sys

import numpy as np
import pytest
from yade import wrapper

import cd_engine

from . import plane


@pytest.fixture
def cd(O):
    return cd_engine.ContactDynamics


@pytest.mark.parametrize("name", cd_engine.ENGINES)
def test_classes_are_derived_from_global_engine_known_to_yade_and_documented(O, name):
    """Each attribute with its default and type."""
    cls = getattr(cd_engine, name)
    assert issubclass(cls, wrapper.GlobalEngine) and getattr(wrapper, name) is cls
    assert "To set: " in cls.__doc__ and not cls.__doc__.endswith(": ")  # DashpotWork has no results
    for attribute in set(plane.everything_in(cls())) - {"dead", "ompThreads", "label"}:
        text = getattr(cls, attribute).__doc__
        assert ":ydefault:`" in text and ":yattrtype:`" in text and len(text) > 60, attribute


def test_attributes_that_scripts_rely_on(cd):
    assert {"gravity", "tolerance", "maxIterations", "fixedIterations", "method", "warmStart", "restitution", "seed", "iterations", "residual",
            "residualMax", "converged", "contacts", "slidingContacts", "maxPenetration", "dissipatedEnergy"} <= set(cd().dict())
    assert "Must be above 0 and at most 1." in cd.tolerance.__doc__ and "at least 0 and at most 1" in cd.restitution.__doc__


def test_help_and_dict_show_settings_and_results_only(O, cd):
    """Settings first; what the engine remembers from step to step is saved, but not shown."""
    text = pydoc.render_doc(cd, renderer=pydoc.plaintext)
    head = text[:text.index("Method resolution order")]
    assert re.search(r"To set: gravity, tolerance.*To read after a step: iterations, residual", head, re.S)
    plane.grid(200, 200, (0, 0.0099), (0.1, 0), plane.ground())
    engine = plane.run(3, 1e-3, gravity=(0, -9.81, 0))
    assert len(engine._referenceOverlaps) == 200
    hidden = [name for name in plane.everything_in(engine) if name.startswith("_")]
    assert len(hidden) == 10 and not [name for name in hidden if name in text or name[1:] in text]
    assert len(repr(engine.dict())) < 2000 and not [name for name in engine.dict() if name.startswith("_")]
    with pytest.raises(AttributeError, match="_referenceOverlaps"):
        cd(_referenceOverlaps=[1.0])
    with pytest.raises(AttributeError):
        engine._referenceOverlaps = []


def test_a_copy_has_the_settings_and_made_no_step(O, cd):
    plane.floor()
    plane.disk((0, 0.0099), 0.01)
    engine = plane.run(3, 1e-3, gravity=(0, -9.81, 0), tolerance=1e-5, flowTolerance=1e-3, label="one")
    results = {name for name in engine.dict() if not getattr(cd, name).fset}
    for twin in (copy.deepcopy(engine), pickle.loads(pickle.dumps(engine))):
        assert {name: value for name, value in twin.dict().items() if name not in results} == \
            {name: value for name, value in engine.dict().items() if name not in results}
        assert twin.steps == 0 and twin.status == cd().status != engine.status


def test_keyword_constructor_sets_attributes(cd):
    engine = cd(tolerance=1e-9, gravity=(1, 2, 0), label="name", seed=3, warmStart=False)
    values = engine.dict()
    found = values["tolerance"], tuple(values["gravity"]), values["label"], values["seed"], values["warmStart"]
    assert found == (1e-9, (1, 2, 0), "name", 3, False)


@pytest.mark.parametrize("keywords, error, words", [
    (dict(tolerance=0), ValueError, "above 0"),
    (dict(tolerance=float("nan")), ValueError, "tolerance"),
    (dict(restitution=1.1), ValueError, "at most 1"),
    (dict(maxIterations=0), ValueError, "at least 1"),
    (dict(maxIterations=2**40), ValueError, "maxIterations=1099511627776 is out of range: it must be at least 1 and at most 2147483647"),
    (dict(tolerance=10**400), ValueError, "above 0 and at most 1"),
    (dict(method="magic"), ValueError, "nsgs"),
    (dict(gravity=(0, float("inf"), 0)), ValueError, "finite"),
    (dict(maxIterations="many"), TypeError, "must be a whole number, not of type str"),
    (dict(residual=1.0), AttributeError, "cannot be set"),
    (dict(publish="sometimes"), ValueError, "'due', 'always'"),
    (dict(threads=1025), ValueError, "threads=1025 is out of range: it must be at least 0 and at most 1024"),
])
def test_bad_keyword_is_refused_with_its_name(cd, keywords, error, words):
    with pytest.raises(error, match=words):
        cd(**keywords)


def test_numbers_of_numpy_are_numbers(cd):
    engine = cd(maxIterations=np.int64(50), tolerance=np.float64(1e-3), reduce=np.bool_(False))
    engine.seed = np.int32(2)
    assert (engine.maxIterations, engine.tolerance, engine.reduce, engine.seed) == (50, 1e-3, False, 2)


def test_bad_assignment_is_refused_and_keeps_the_old_value(cd):
    engine = cd()
    with pytest.raises(ValueError, match="out of range"):
        engine.restitution = -1
    with pytest.raises(AttributeError, match="ContactDynamics.iterations is a result and cannot be set. The most .* `maxIterations`"):
        engine.iterations = 1
    assert engine.restitution == 0


def test_a_misspelt_attribute_is_refused_with_the_right_name(cd):
    for engine, wrong, right in ((cd(), "tolerence", "tolerance"), (cd(), "tol", "tolerance"), (cd(), "solver", "method"),
                                 (cd(), "numThreads", "threads"), (cd_engine.DashpotWork(), "worc", "work")):
        for assign in (setattr, lambda engine, name, value: engine.updateAttrs({name: value})):
            with pytest.raises(AttributeError, match=rf"no attribute '{wrong}'\. Did you mean {right}\?"):
                assign(engine, wrong, 1e-3)
        assert not hasattr(engine, wrong)
    class Named(cd_engine.DashpotWork):  # in Python, with attributes of its own
        pass
    Named().note = 1
    with pytest.raises(AttributeError, match=r"no attribute 'qqqqq'\. help"):
        cd().qqqqq = 1


def test_positional_arguments_are_refused(cd):
    with pytest.raises(TypeError, match="keyword"):
        cd(1e-6)


def test_label_reaches_the_engine(O, cd):
    O.engines = cd_engine.engines(label="contactDynamics")
    assert O.labeledEngine("contactDynamics") == O.engines[-1] and type(O.engines[-1]) is cd


@pytest.mark.parametrize("ending", [".xml", ".xml.gz", ".yade", ".yade.gz"])
def test_saving_keeps_every_attribute(O, cd, tmp_path, ending):
    plane.grid(4, 1, (0, 0.0099), (0, 0.0199), plane.ground())
    engine = plane.run(7, 1e-3, gravity=(0, -9.81, 0), tolerance=3e-9, seed=5, label="kept")
    before = plane.everything_in(engine)
    assert before["_referenceOverlaps"]  # otherwise the vectors would be tested empty
    O.save(str(tmp_path / ("scene" + ending)))
    O.reset()
    O.load(str(tmp_path / ("scene" + ending)))
    assert plane.everything_in(O.engines[-1]) == before


def test_a_scene_of_another_version_is_refused(O, cd, tmp_path):
    """Values read into other attributes would be nonsense, or ask for endless memory."""
    plane.disk((0, 0), 0.01)
    plane.run(1, 1e-3)
    path = tmp_path / "scene.xml"
    O.save(str(path))
    text = path.read_text()
    assert "restTrialPause " in text
    path.write_text(text.replace("restTrialPause ", "", 1))
    with pytest.raises(RuntimeError, match="saved by another version of this engine"):
        O.load(str(path))


def test_timing_counts_the_engine(O, cd):
    plane.columns(0, disks=1)
    O.timingEnabled = True
    try:
        engine = plane.run(5, 1e-3, gravity=(0, -9.81, 0))
        assert engine.execCount == 5 and engine.execTime > 0
    finally:
        O.timingEnabled = False


def test_import_without_yade_names_the_remedy(root):
    """In a Python without YADE the package itself imports; asking for the engine says what is missing, and help() does not ask for it."""
    code = "import cd_engine\nhelp(cd_engine)\ntry:\n    cd_engine.ContactDynamics\nexcept ImportError as e:\n    print(e)"
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True)
    assert "timeStep(" in done.stdout and "needs a running YADE" in done.stdout, done.stderr


def test_tab_finds_what_a_user_calls(cd):
    assert dir(cd_engine) == sorted(cd_engine.__all__)
