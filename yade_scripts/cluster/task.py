"""One task of a sweep's array job: its share of the rows, one after the other, each in its own YADE. Called by Slurm.

    /usr/bin/python3 yade_scripts/cluster/task.py ROWS.json INDEX TASKS

Task INDEX of TASKS has every TASKS-th row from INDEX on. Rows that are finished are skipped, so that a task that is put back into the queue,
or submitted again, goes on where it stopped. Exit status: 0 every row has ended with a result file, 1 one has left none.
"""
import json
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2]))

from yade_scripts import results, study


def main(arguments):
    """Command line."""
    path, index, tasks = arguments[0], int(arguments[1]), int(arguments[2])
    os.environ["OMP_NUM_THREADS"] = "1"  # several threads are not repeatable
    plan, without = json.loads(pathlib.Path(path).read_text()), 0
    for row in plan["rows"][index::tasks]:
        job = study.Job(row, plan["results"])
        if not results.finished(job.path):
            job.start()
            job.process.wait()
        print(f"{job.path}: {job.outcome()}", flush=True)
        without += results.status(job.path) is None
    return 1 if without else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
