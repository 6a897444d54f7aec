"""The registry: what is refused, and what a row's name depends on."""
import importlib
import math
import subprocess
import sys

import pytest
from hypothesis import given, strategies as st

from yade_scripts import declared, parameters, scenes
from yade_scripts.parameters import ParameterError, REGISTRY, complete


def test_defaults_of_every_scene_pass_their_own_checks():
    for scene in scenes.names():
        full = complete({"scene": scene, "method": scenes.module(scene).METHODS[-1]})
        assert set(full) == set(parameters.registry(scene))
        assert complete(full) == full


def test_every_scene_declares_what_it_is():
    owners = {}
    for name in scenes.names():
        scene = scenes.module(name)
        assert all(isinstance(text, str) and text for text in (scene.TITLE, scene.HORIZON, scene.LEFT_OUT))
        assert scene.METHODS in (("MD", "CD"), ("MD",), ("CD",)) and complete({"scene": name})["method"] in scene.METHODS
        assert set(scene.DEFAULTS) <= set(REGISTRY), "defaults of a scene's own parameters stand where they are declared"
        for parameter in scene.PARAMETERS:
            assert parameter.name not in REGISTRY and parameter.check(parameter.default) == parameter.default
            assert type(parameter.default) is type(owners.setdefault(parameter.name, parameter).default), "a typed value is read by its name alone"


def test_declarations_need_no_yade(root):
    """Nor do the commands that start runs. Isolated (-I), so that no folder of YADE's is on the path, whatever the environment says."""
    code = ("import sys; sys.path.insert(0, '.'); from yade_scripts import batch, parameters, scenes; from yade_scripts.measuring import regression;"
            "parameters.listing(); print('yade' in sys.modules, len(scenes.names()))")
    done = subprocess.run([sys.executable, "-I", "-c", code], cwd=root, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", str(len(scenes.names()))]


@pytest.fixture
def own(monkeypatch):
    """A parameter that only the scene stack has."""
    parameter = parameters.Parameter("lean", 1, "degree", "of the stack", low=0, high=10)
    monkeypatch.setattr(scenes.module("stack"), "PARAMETERS", (parameter,))
    return parameter


def test_a_scene_s_own_parameter_counts_in_its_rows_alone(own):
    name = lambda **row: parameters.result_name(complete(row))
    assert complete({"scene": "stack"})["lean"] == 1 and complete({"scene": "stack", "lean": 3})["lean"] == 3
    assert name(scene="stack") == name(scene="stack", lean=1) != name(scene="stack", lean=2)
    assert "lean" not in complete({}) and "lean" in parameters.listing()
    assert parameters.from_arguments(["scene=stack", "lean=2"]) == {"scene": "stack", "lean": 2}
    with pytest.raises(ParameterError, match="lean = 11: must be an integer in .0, 10. .degree. .of the stack"):
        complete({"scene": "stack", "lean": 11})
    with pytest.raises(ParameterError, match="unknown parameter 'lean' .value 2.; scene biaxial has none of that name, stack has"):
        complete({"lean": 2})


@pytest.mark.parametrize("changes, words", [
    ({"DEFAULTS": {"frictoin": 0.3}}, "stack.py: DEFAULTS: unknown parameter 'frictoin' .value 0.3.; did you mean friction"),
    ({"DEFAULTS": {"friction": 3}}, "stack.py: DEFAULTS: friction = 3: must be a number in"),
    ({"PARAMETERS": (parameters.Parameter("friction", 0.5, "1", "made up"),)}, "stack.py: PARAMETERS repeats friction, which every scene has"),
    ({"PARAMETERS": parameters.Parameter("push", 0.5, "1", "made up")}, r"stack.py: PARAMETERS must be a tuple; .* a comma: \(element,\)"),
    ({"METHODS": "CD"}, "stack.py: METHODS must be a tuple"),
    ({"POSITIVE": ("sped",)}, "stack.py: POSITIVE names sped, which are no parameters of the scene")])
def test_a_wrong_parameter_of_a_scene_is_refused_with_its_file(monkeypatch, changes, words):
    for name, value in changes.items():
        monkeypatch.setattr(scenes.module("stack"), name, value)
    with pytest.raises(ParameterError, match=words) as caught:
        complete({"scene": "stack"})
    assert str(caught.value).count("stack.py") == 1
    complete({"scene": "cradle", "gap": 0.1})  # another scene costs it nothing


def test_a_default_out_of_its_own_range_is_refused():
    with pytest.raises(ParameterError, match="speed = -1.0: must be a number in .0, 10. .m/s. .at the start"):
        parameters.Parameter("speed", -1.0, "m/s", "at the start", low=0, high=10)


def test_a_scene_that_lacks_something_is_refused(monkeypatch):
    file = scenes.module("stack")
    for name in ("KIND", "build"):
        monkeypatch.delattr(file, name)
    with pytest.raises(ParameterError, match="stack.py lacks KIND, build; .*scenes/__init__.py explains what the file has to declare"):
        complete({"scene": "stack"})


@pytest.mark.parametrize("text, words", [
    ("import maths", "one.py: No module named 'maths'$"), ("TITLE = (", r"one.py: SyntaxError: .*line 1\); correct it$"),
    ("\nTITLE = titel", "one.py, line 2: NameError: name 'titel' is not defined; correct it$"),
    ("raise ModuleNotFoundError('No module', name='yade')", "one.py: No module; import what needs YADE inside a function")])
def test_a_file_that_fails_is_located(tmp_path, monkeypatch, text, words):
    folder = tmp_path / "some_scenes"
    folder.mkdir()
    (folder / "__init__.py").touch()
    (folder / "one.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    for name in ("some_scenes", "some_scenes.one"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    importlib.import_module("some_scenes")
    with pytest.raises(ImportError, match=words):
        declared.load("some_scenes", "one", (), {})


def test_an_import_that_fails_in_build_is_located(O, monkeypatch):
    monkeypatch.setattr(scenes.module("stack"), "build", lambda full, folder: importlib.import_module("maths"))
    with pytest.raises(ImportError, match="stack.py: No module named 'maths'"):
        scenes.build(complete({"scene": "stack"}), "results")


def test_a_build_that_returns_nothing_is_named(O, monkeypatch):
    monkeypatch.setattr(scenes.module("stack"), "build", lambda full, folder: None)
    with pytest.raises(ParameterError, match=r"^build\(\) of scene stack must return a Scene$"):
        scenes.build(complete({"scene": "stack"}), "results")


def test_a_new_parameter_orphans_no_result(monkeypatch):
    """A new parameter, general or of a scene, keeps all names of results; a value other than its default gives another name."""
    rows = [{"scene": scene} for scene in scenes.names()] + [{"seed": 3}, {"scene": "stack", "disks": 7}]
    before = [parameters.result_name(complete(row)) for row in rows]
    packing = parameters.digest(parameters.preparation(complete({"seed": 3})))
    new = parameters.Parameter("stress_path", "constant", "1", "made up", choices=("constant", "mean"), prepare=True)
    monkeypatch.setitem(parameters.REGISTRY, "stress_path", new)
    monkeypatch.setattr(scenes.module("stack"), "PARAMETERS", (parameters.Parameter("weight", 1.0, "kg", "made up"),))
    assert [parameters.result_name(complete(row)) for row in rows] == before
    assert parameters.digest(parameters.preparation(complete({"seed": 3}))) == packing
    assert parameters.result_name(complete({"seed": 3, "stress_path": "mean"})) != parameters.result_name(complete({"seed": 3}))


def test_a_new_meaning_of_the_defaults_names_all_runs_anew(monkeypatch):
    before = parameters.result_name(complete({}))
    monkeypatch.setattr(parameters, "MEANING", parameters.MEANING + 1)
    assert parameters.result_name(complete({})) != before


def test_a_method_without_meaning_in_a_scene_is_refused_with_the_reason():
    for name in scenes.names():
        for method in {"MD", "CD"} - set(scenes.module(name).METHODS):
            with pytest.raises(ParameterError) as refused:
                complete({"scene": name, "method": method})
            other, reason = scenes.module(name).METHODS[0], scenes.module(name).ONLY
            assert str(refused.value) == f"method = '{method}': the scene {name} runs by {other} only, since {reason}" and "METHODS" not in reason


def test_row_overrides_scene_overrides_registry():
    assert complete({"scene": "stack"})["disks"] == 50
    assert complete({"scene": "stack", "disks": 7})["disks"] == 7
    assert complete({})["disks"] == 400


def test_unknown_name_is_refused_with_the_near_ones():
    with pytest.raises(ParameterError, match="unknown parameter 'frction'.*friction"):
        complete({"frction": 0.2})


def test_an_accuracy_is_asked_of_another_command():
    with pytest.raises(ParameterError, match="unknown parameter 'accuracy'.*yade_scripts/accuracy.py"):
        complete({"accuracy": "1e-3"})


@pytest.mark.parametrize("row", [dict(delta_sigma=1.0), dict(loading="ramp", ramp_rate=0.2, period=5.0)])
def test_a_lateral_stress_below_zero_is_refused(row):
    with pytest.raises(ParameterError, match="sigma1 = 2 P0 - sigma2 would be zero or negative"):
        complete({"stress_path": "mean"} | row)
    complete({"stress_path": "constant"} | row)


@pytest.mark.parametrize("name, value", [
    ("friction", -0.1), ("friction", math.nan), ("friction", math.inf), ("friction", "rough"), ("friction", True), ("friction", None),
    ("seed", 1.5), ("seed", -1), ("disks", 0), ("delta_sigma", 0), ("delta_sigma", 10.1), ("warm_start", 1), ("method", "ED"),
    ("scene", "true_triaxial"), ("cd_dt", 0.0), ("tolerance", 0)])
def test_wrong_value_is_refused_with_name_value_and_range(name, value):
    with pytest.raises(ParameterError) as caught:
        complete({name: value})
    message = str(caught.value)
    assert name in message and repr(value) in message and REGISTRY[name].allowed() in message
    assert "\n" not in message and "[1]" not in message and (REGISTRY[name].unit == "1" or f" [{REGISTRY[name].unit}] (" in message)


@pytest.mark.parametrize("row, word", [({"records_per_cycle": 7}, "even"), ({"depth": 0.01}, "diameter"),
                                       ({"method": "CD", "cd_dt": 1e-300}, "at most 1e\\+12")])
def test_values_that_do_not_go_together(row, word):
    with pytest.raises(ParameterError, match=word):
        complete(row)


@pytest.mark.parametrize("scene", [scene for scene in scenes.names() if not scenes.module(scene).DEFAULTS.get("gravity")])
def test_gravity_is_refused_where_a_scene_does_not_declare_it(scene):
    """Packings are prepared without gravity and stored under a name that does not know it."""
    with pytest.raises(ParameterError, match=f"gravity = 1e-07: the scene {scene} has no gravity: set gravity = 0; .* declares it in DEFAULTS"):
        complete({"scene": scene, "gravity": 1e-7})


@given(st.sampled_from(sorted(REGISTRY)), st.one_of(st.floats(), st.integers(), st.booleans(), st.text(max_size=5), st.none()))
def test_any_value_is_refused_or_comes_out_allowed(name, value):
    """Whatever passes is of the default's type and inside the range; nothing but ParameterError is raised."""
    try:
        full = complete({name: value})
    except ParameterError:
        return
    parameter, result = REGISTRY[name], full[name]
    assert type(result) is type(parameter.default) and result == value
    if not isinstance(result, (bool, str)):
        assert parameter.low <= result <= parameter.high and result > parameter.above


@given(st.floats(allow_nan=False), st.sampled_from(["friction", "kn", "tolerance"]))
def test_a_typed_number_is_read_back_exactly(value, name):
    assert parameters.from_text(name, repr(value)) == value


def test_arguments():
    row = parameters.from_arguments(["seed=3", "method='CD'", "warm_start=False", "kn=1e6"])
    assert row == {"seed": 3, "method": "CD", "warm_start": False, "kn": 1e6}
    for wrong in (["seed"], ["seed=1", "seed=2"]):
        with pytest.raises(ParameterError):
            parameters.from_arguments(wrong)


def test_result_name_depends_on_what_the_method_reads_only():
    name = lambda **row: parameters.result_name(complete(row))
    assert name(method="MD") == name(method="MD", cd_dt=5e-4)
    assert name(method="CD") != name(method="CD", cd_dt=5e-4)
    assert name(method="MD") != name(method="CD") != name(method="CD", seed=2)
    assert name(kn=2000000) == name(kn=2e6)


def test_packing_depends_on_no_parameter_of_the_run():
    shapes = lambda **row: parameters.preparation(complete(row))
    assert shapes() == shapes(method="CD", period=3.0, delta_sigma=0.5, tolerance=1e-3, md_walls="force")
    for change in ({"friction": 0.2}, {"seed": 2}, {"kn": 1e6}, {"pressure_ratio": 1e-3}):
        assert shapes() != shapes(**change)


def test_names_are_the_same_in_every_process(root):
    code = "from yade_scripts import parameters as p; print(p.result_name(p.complete({'seed': 5})))"
    names = {subprocess.run([sys.executable, "-c", code], cwd=root, env={"PYTHONHASHSEED": seed}, capture_output=True, text=True,
                            check=True).stdout.strip() for seed in "12"}
    assert names == {parameters.result_name(complete({"seed": 5}))}


def test_paper_s_values():
    """Caption of Fig. 3."""
    full = complete({})
    assert (full["disks"], full["kn"], full["friction"]) == (400, 2e6, 0.1)
    assert parameters.pressure(full) == pytest.approx(6e-4 * 2e6, rel=1e-15)


def test_the_methods_of_cd_are_the_engines_own():
    """A wrong method is refused with the names of the right ones, before the first step."""
    import yade
    import cd_engine
    assert yade.O is not None  # which the engine needs
    assert set(REGISTRY["method_cd"].choices) == set(cd_engine.methods())
    with pytest.raises(ParameterError, match="method_cd = 'magic': must be one of nsgs"):
        complete({"method": "CD", "method_cd": "magic"})


def test_a_file_with_a_fault_costs_other_scenes_nothing(monkeypatch):
    whole = scenes.module
    def module(name):
        if name == "arch":
            raise ImportError("arch.py: a fault")
        return whole(name)
    monkeypatch.setattr(scenes, "module", module)
    assert parameters.from_text("slot", "9") == 9 and complete({"scene": "hopper", "slot": 9.0})["slot"] == 9
    with pytest.raises(ParameterError, match="did you mean seed"):
        complete({"sed": 1})
    with pytest.raises(ImportError, match="a fault"):
        complete({"scene": "arch"})


def test_help_says_what_the_list_is(root):
    done = subprocess.run([sys.executable, "-m", "yade_scripts.parameters", "--help"], cwd=root, capture_output=True, text=True)
    assert done.stdout.startswith("usage: python3 -m yade_scripts.parameters [-h]") and "cd_dt" not in done.stdout and not done.returncode


def test_the_list_may_be_cut(root):
    """`| head` may cut the list without a traceback."""
    done = subprocess.run(f"{sys.executable} -m yade_scripts.parameters | head -1", shell=True, cwd=root, capture_output=True, text=True)
    assert done.stdout.startswith("scene") and not done.stderr
