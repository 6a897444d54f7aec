"""The benchmark as `make bench` runs it: a minute of measuring, which tests that the parts, tested elsewhere, fit together."""
import json
import subprocess

from analysis import benchmark, publish


def test_quick_benchmark(root, tmp_path):
    """From nothing to tables and figures, once; started again it has nothing left to do."""
    folder = tmp_path / "benchmark" / "quick"

    def run(*more):
        return subprocess.run(["/usr/bin/python3", "-m", "yade_scripts.measuring.benchmark", "--quick", "--results", str(tmp_path), *more], cwd=root,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=1200)

    done = run()
    assert done.returncode == 0, done.stdout + done.stderr
    tables = {name: publish.read_table(folder / f"{name}.csv") for name in ("solutions", "sweeps")}
    packed = tables["solutions"][tables["solutions"].kind == "packing"]
    assert set(packed.start) == {"cold", "warm"} and (packed.residual <= packed.target).all()
    assert (tables["sweeps"][["plain_any_ns", "accelerated_ns", "bound_plain_ns"]] > 0).all().all()
    facts = json.loads(next((folder / "problems").glob("*-0.1.json")).read_text())
    assert facts["residual"] < 1e-6 and facts["solid_fraction"] > 0.78 and facts["contacts_per_disk"] > 3.2
    assert {path.name for path in benchmark.draw(folder)} == {"error_against_time.png", "step_cost.png", "sweep_cost.png"}
    again = run()
    assert again.returncode == 0 and "[1/" not in again.stdout
    one = run("--table", "sweeps", "--again")
    assert one.returncode == 0 and "sweeps" in json.loads((folder / "provenance.json").read_text())["tables"]
    missing = run(str(tmp_path / "nowhere.hdf5"))
    assert missing.returncode == 2 and "nowhere.hdf5" in missing.stderr and "Traceback" not in missing.stderr
