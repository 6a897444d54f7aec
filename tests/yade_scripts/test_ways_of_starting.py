"""Each script that YADE starts, in every way that YADE has: it does its work, or says in one sentence what to give."""
import subprocess

import pytest

from tests.analysis.conftest import write_row

from .conftest import SCRIPTS, Yade

EXAMPLES = [f"examples/{name}.py" for name in ("drum", "heap", "hopper", "loaded_box")]
TABLES = {"run.py": "scene disks method\nstack 2 CD\n", "preparing/prepare.py": "disks seed\n20 4\n", "console.py": "scene disks\nstack 7\n"}
NEEDS = {  # those that cannot do anything without arguments
    "accuracy.py": "accuracy: accuracy=...: an error such as accuracy=1e-3 has to be given",
    "batch.py": "batch.py: error: the following arguments are required: TABLE",
    "cluster/sweep.py": "sweep.py: error: the following arguments are required: TABLE",
    "measuring/in_yade.py": "in_yade.py: needs a module and its settings; python3 -m yade_scripts.measuring starts it with them"}
WORDS = {"run.py": "finished", "preparing/prepare.py": ".yade.gz", "console.py": "The packing is loaded"} | dict.fromkeys(EXAMPLES, "s of computing")
NO_GLOBALS = ("console.py", *EXAMPLES)  # what they define is meant for the user of the console


@pytest.fixture(scope="module")
def yade(tmp_path_factory):
    """YADE in a folder in which the row of defaults has already run."""
    runner = Yade(tmp_path_factory.mktemp("ways"))
    (runner.folder / "results").mkdir()
    write_row(runner.folder / "results", {})
    return runner


def check(done, script):
    """One sentence about what is missing, or the words of what has been done."""
    assert "Traceback" not in done.stderr
    if script in NEEDS:
        assert done.returncode and NEEDS[script] in done.stderr.splitlines()[-1]
    else:
        assert done.returncode == 0 and WORDS[script] in done.stdout, done.stdout + done.stderr


@pytest.mark.parametrize("with_table", [False, True], ids=["no table", "table"])
@pytest.mark.parametrize("script", [*WORDS, *NEEDS])
def test_a_batch(yade, script, with_table):
    """Where nothing has to be given and there is no table, the row of defaults runs."""
    table = yade.folder / "table.txt"
    table.write_text(TABLES.get(script, "disks seconds\n30 0.1\n"))
    done = yade.script(script, YADE_BATCH=f"{table}:2" if with_table else "")
    if script == "accuracy.py" and with_table:
        assert done.returncode == 2 and "the table of yade-batch cannot give an accuracy" in done.stderr.splitlines()[-1]
    else:
        check(done, script)


@pytest.mark.parametrize("script", [*WORDS, *NEEDS])
def test_execfile_at_the_console(yade, script):
    """The console's names are local ones. Its arguments are those of another script, and it goes on."""
    path = yade.folder / "console_calls.py"
    path.write_text(f"def console():\n    execfile({str(SCRIPTS / script)!r})\ntry:\n    console()\nfinally:\n    print(sys.argv[1:])\n")
    done = yade.script(path, "disks=30", "seconds=0.1")
    assert done.stdout.splitlines()[-1] == "['disks=30', 'seconds=0.1']"
    if script in NO_GLOBALS:
        assert done.returncode == 1 and done.stderr.splitlines()[-1].startswith(f"write execfile('{SCRIPTS / script}', globals())")
        path.write_text(path.read_text().replace(".py')", ".py', globals())"))
        done = yade.script(path, "disks=30", "seconds=0.1")
    check(done, script)


@pytest.mark.parametrize("arguments, words", [(["run.py"], "this run is already finished"), (["table.txt", "run.py"], "stack-CD-")])
def test_yade_batch_itself(yade, arguments, words):
    (yade.folder / "table.txt").write_text(TABLES["run.py"])
    subprocess.run(["yade-batch", "--log=batch.log", *(SCRIPTS / name if name == "run.py" else name for name in arguments)], cwd=yade.folder,
                   stdin=subprocess.DEVNULL, capture_output=True, timeout=600)
    said = (yade.folder / "batch.log").read_text()
    assert words in said and "status  : 0 (OK)" in said, said


@pytest.mark.parametrize("script, arguments", [("run.py", ["scene=stack", "disks=2"]), (EXAMPLES[1], ["disks=30", "seconds=0.1"])])
def test_yade_with_its_console_at_the_end(yade, script, arguments):
    """Here it ends at once, as nobody types; the other tests start scripts as yade -n -x does."""
    check(subprocess.run(["yade", SCRIPTS / script, *arguments], cwd=yade.folder, stdin=subprocess.DEVNULL, capture_output=True, text=True), script)


def test_the_runs_of_a_batch_script_are_not_the_rows_of_a_table_around_it(yade):
    table = yade.folder / "around.txt"
    table.write_text("scene disks method\nstack 2 CD\nstack 3 CD\n")
    done = yade.script("batch.py", str(table), YADE_BATCH=f"{table}:2")
    assert done.returncode == 0 and "2 runs" in done.stdout, done.stdout + done.stderr


@pytest.mark.parametrize("command", [["run.py"], ["accuracy.py", "accuracy=1e-3"], ["preparing/prepare.py"]])
def test_python_without_yade(tmp_path, command):
    path = SCRIPTS / command[0]
    done = subprocess.run(["/usr/bin/python3", path, *command[1:]], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr == f"{path.stem}: start it by YADE: yade -n -x {path}\n"
