"""Every command gets random arguments, valid ones and nonsense: it starts, or says in one sentence why not. There is no traceback."""
import importlib
import json
import random

import pytest

from yade_scripts import commands
from yade_scripts.cluster import slurm

NONSENSE = ["", "-", "--", "=", "--x", "--results", "--results=", "nonsense", "0", "-1", "1e9", "nan", "seed=1", "seed=x", "seed=", "=1", "disks=0",
            "method=CD", "method=",
            "scene=chain", "scene=moon", "seed=1_0", "\u00b2", "/", "{folder}", "{folder}/none.txt", "{folder}/file", "{folder}/table.txt",
            "{folder}/file/below"]


class Started(Exception):
    """The arguments were valid: the work would begin."""


def start(*_, **__):
    raise Started


# Program: (module of main, functions replaced by `start`, options).
PROGRAMS = {
    "run": ("yade_scripts.run", ["execute"], ["--checkpoints=3", "--checkpoints=x", "--results={folder}"]),
    "picture": ("yade_scripts.picture", ["show"], ["--film=0.1", "--film=x", "--film=0", "--results={folder}"]),
    "prepare": ("yade_scripts.preparing.prepare", ["ensure"], []),
    "accuracy": ("yade_scripts.accuracy", ["search"], ["accuracy=1e-3", "accuracy=x", "accuracy=-1", "accuracy=nan"]),
    "batch": ("yade_scripts.batch", ["work_off"], ["--jobs", "2", "--hours", "3", "--share", "0/2", "--results", "{folder}"]),
    "sweep": ("yade_scripts.cluster.sweep", ["Sweep"], ["--minutes", "--retries", "--sbatch", "--at-once", "--seconds", "5"]),
    "regression": ("yade_scripts.measuring.regression", ["compare"], ["--quick", "--full", "--record", "{folder}/new.json"]),
    "measuring": ("yade_scripts.measuring.__main__", ["queue.run"], ["--quick", "--full", "--only", "stack", "servo", "--jobs", "2"]),
    "benchmark": ("yade_scripts.measuring.benchmark.__main__", ["run"], ["--quick", "--again", "--results", "{folder}/out"]),
    "analysis": ("analysis.__main__", [], ["study", "table", "summary", "check", "recommend", "--scene", "stack", "--accuracy", "1e-3", "--results",
                                           "-o",
                                           "{folder}/a.png", "--published", "fig4"]),
}


def test_a_name_that_yade_lacks_is_not_taken_for_plain_python(capsys):
    """As by `from yade import sphere` in the file of a scene."""
    def main(arguments):
        raise ImportError("mine.py: cannot import name 'sphere' from 'yade'", name="yade")
    assert commands.command("run")(main)([]) == 2 and "cannot import name 'sphere'" in capsys.readouterr().err


@pytest.mark.parametrize("program", ["regression", "benchmark", "measuring", "analysis"])
def test_the_quick_extent_is_the_default_as_help_says(monkeypatch, capsys, tmp_path, program):
    module = importlib.import_module(PROGRAMS[program][0])
    words = ["study"] if program == "analysis" else []
    with pytest.raises(SystemExit):
        module.main([*words, "--help"])
    said = " ".join(capsys.readouterr().out.split())
    assert "(default)" in said[said.index(" --quick "):].split(" --")[1] and said.count("(default)") == 1
    asked = []

    def extent(full):
        asked.append("full" if full else "quick")
        raise Started

    if program == "regression":
        few = sum(case["quick"] for case in json.loads(module.STORED.read_text())["cases"])
        monkeypatch.setattr(module, "compare", lambda cases, folder: extent(len(cases) > few))
    elif program == "benchmark":
        monkeypatch.setattr(module.pieces, "quick", lambda *_: extent(False))
        monkeypatch.setattr(module.pieces, "full", lambda *_: extent(True))
    elif program == "measuring":
        monkeypatch.setattr(module, "Measurements", lambda kind, name, full, folder: extent(full))
    else:
        monkeypatch.setattr("analysis.publish.publish_all", lambda names, figures, results, full: extent(full))
    for option in ([], ["--quick"], ["--full"]):
        with pytest.raises(Started):
            module.main([*words, *option, *(["--results", str(tmp_path)] if program != "regression" else []),
                         *(["-o", str(tmp_path)] if program == "analysis" else [])])
    assert asked == ["quick", "quick", "full"]


@pytest.mark.parametrize("program", PROGRAMS)
def test_help_begins_with_whole_sentences(program):
    """The options stand after the first paragraph."""
    assert importlib.import_module(PROGRAMS[program][0]).__doc__.partition("\n\n")[0].endswith(".")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with a file and a table; it is the working folder, to which defaults refer."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("analysis.__main__.FIGURES", tmp_path / "figures")
    (tmp_path / "file").write_text("neither a table nor a result\n")
    (tmp_path / "table.txt").write_text("seed method\n1 MD\n2 CD\n")
    return tmp_path


@pytest.mark.parametrize("program", PROGRAMS)
def test_arguments(folder, monkeypatch, capsys, program):
    name, work, options = PROGRAMS[program]
    module, draw = importlib.import_module(name), random.Random(program)
    for function in work:
        monkeypatch.setattr(f"{name}.{function}", start)
    monkeypatch.setattr(slurm, "present", lambda: True)
    ends = {"started": 0, "refused": 0}
    for _ in range(300):
        arguments = [draw.choice(draw.choice((options or NONSENSE, NONSENSE))).replace("{folder}", str(folder)) for _ in range(draw.randint(0, 4))]
        try:
            status = module.main(arguments)
        except Started:
            ends["started"] += 1
            continue
        except SystemExit as end:
            status = end.code
        said = capsys.readouterr()
        assert status in (0, 1, 2), (arguments, status)
        if status:
            ends["refused"] += 1
            assert len(said.err or said.out) > 20, (arguments, said)  # `analysis check` prints its answer to stdout
    assert ends["refused"] > 50 and (ends["started"] or not work), ends
