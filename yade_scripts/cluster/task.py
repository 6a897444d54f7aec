"""Runs one task of a sweep: its share of the rows, one after the other, each in a YADE process of its own. Slurm calls it.

    /usr/bin/python3 yade_scripts/cluster/task.py ROWS.json INDEX TASKS

Task INDEX runs every TASKS-th row, beginning with row INDEX. Finished rows are skipped, so a task that Slurm starts again continues where it
stopped. Exit status: 0 every row has ended with a result file, 1 one has left none.
"""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2]))

from yade_scripts import batch, commands, results
from yade_scripts.running import queue


@commands.command("task")
def main(arguments=None):
    parser = commands.parser(__doc__)
    parser.add_argument("rows", metavar="ROWS.json", type=pathlib.Path)
    parser.add_argument("index", metavar="INDEX", type=commands.whole(0))
    parser.add_argument("tasks", metavar="TASKS", type=commands.whole(1))
    options = parser.parse_args(arguments)
    plan = json.loads(options.rows.read_text(encoding="utf-8"))
    jobs = [batch.Row(row, plan["results"]) for row in plan["rows"][options.index::options.tasks]]
    queue.run([job for job in jobs if not results.finished(job.path)], 1)
    return 1 if any(results.status(job.path) is None for job in jobs) else 0


if __name__ == "__main__":
    sys.exit(main())
