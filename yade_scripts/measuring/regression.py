"""Runs scenes by `yade -n -x` and compares their numbers with those stored in regression.json.

    /usr/bin/python3 yade_scripts/measuring/regression.py [--quick | --full] [--record NEW.json]

Each stored number has a tolerance and the reason for it. --record writes the new numbers to a new file, so that a person can compare and
adopt them; no file is overwritten. Exit status: 0 no number changed by more than its tolerance, 1 some did, 2 the run cannot be made.
"""
import json
import pathlib
import sys
import tempfile

if __name__ == "__main__":
    file = sys._getframe().f_code.co_filename  # YADE sets no __file__
    sys.path.insert(0, str(pathlib.Path(file).resolve().parents[2]))
    from yade_scripts import commands
    commands.script("yade_scripts.measuring.regression", file)

from yade_scripts import batch, commands, results
from yade_scripts.errors import ParameterError
from yade_scripts.results import sealed
from yade_scripts.running import queue

STORED = pathlib.Path(__file__).with_name("regression.json")
PICK = {"first": lambda a: a[0], "last": lambda a: a[-1], "min": min, "max": max}


def value(path, quantity):
    """Return a number of a result file: known/NAME, or history/FIELD/(first|last|min|max)."""
    with sealed.open_checked(path) as file:
        kind, name, *pick = quantity.split("/")
        return float(file[f"known/{name}"][()]) if kind == "known" else float(PICK[pick[0]](file[f"history/{name}"][:]))


def run_cases(cases, folder):
    """Run the cases. Return {name: (result file, None) or (None, reason of failure)}."""
    jobs = {case["name"]: batch.Row(case["row"], folder) for case in cases}
    queue.run(list({job.path: job for job in jobs.values()}.values()), 2)
    return {name: (job.path, None) if results.finished(job.path) else (None, job.outcome()) for name, job in jobs.items()}


def compare(cases, folder):
    """Run the cases and print a line for each number. Return how many drifted. Store each new value in its number under `now`."""
    drifted, ran = 0, run_cases(cases, folder)
    print(f"{'case':18} {'quantity':34} {'stored':>22} {'now':>22} {'difference':>11} {'tolerance':>10}")
    for case in cases:
        path, failure = ran[case["name"]]
        if failure:
            drifted += 1
            print(f"{case['name']:18} {failure}   <-- FAILED")
            continue
        for number in case["numbers"]:
            number["now"] = value(path, number["quantity"])
            difference = number["now"] - number["value"]
            drift = not abs(difference) <= number["tolerance"]
            drifted += drift
            print(f"{case['name']:18} {number['quantity']:34} {number['value']:22.15g} {number['now']:22.15g} {difference:11.2e} "
                  f"{number['tolerance']:10.1e}{'   <-- DRIFTED; tolerance: ' + number['reason'] if drift else ''}")
    return drifted


def record(stored, path):
    """Write the stored numbers to a new file, measured ones with their new values and exact ones unchanged. An existing file is not overwritten."""
    if old := [case["name"] for case in stored["cases"] if not any("now" in number for number in case["numbers"])]:
        print(f"Not run, or failed, so that the stored numbers stay: {', '.join(old)}")
    for number in (number for case in stored["cases"] for number in case["numbers"]):
        now = number.pop("now", number["value"])
        number["value"] = number["value"] if number["exact"] else now
    with open(path, "x") as file:
        file.write(json.dumps(stored, indent=1) + "\n")
    print(f"Written {path}; compare it with {STORED.name}, and replace that file if every change is intended.")


@commands.command("regression")
def main(arguments=None):
    parser = commands.parser(__doc__)
    commands.add_extent(parser, "only the quick cases", "all cases")
    parser.add_argument("--record", metavar="NEW.json", help="write the numbers found to a new file")
    options = parser.parse_args(arguments)
    if options.record and pathlib.Path(options.record).exists():
        raise ParameterError(f"{options.record} exists; name a new file")
    if options.record and not pathlib.Path(options.record).absolute().parent.is_dir():
        raise ParameterError(f"{options.record}: there is no such folder; make it first")
    stored = json.loads(STORED.read_text())
    cases = [case for case in stored["cases"] if case["quick"] or options.full]
    with tempfile.TemporaryDirectory() as folder:
        drifted = compare(cases, folder)
    if options.record:
        record(stored, options.record)
    print(f"{drifted} of {sum(len(case['numbers']) for case in cases)} numbers drifted." if drifted else "Nothing drifted.")
    return 1 if drifted else 0


def begin():
    queue.end_by_signals("regression")
