"""Makes the measurements for the charts of speed against accuracy and the maps of stability. Existing measurements are not repeated.

    /usr/bin/python3 -m yade_scripts.measuring [--quick | --full] [--only stack md_contact] [--series "MD step"] [--jobs 2]

One YADE process measures a whole chart or map. A measurement that crashes or takes too long is stored as failed, and the others go on.
Exit status: 0 all is measured (failures are results, too), 1 something could not be measured, 2 wrong arguments.
"""
import json
import pathlib
import signal
import sys

from yade_scripts import commands, results
from yade_scripts.errors import ParameterError
from yade_scripts.measuring import charts, maps, store
from yade_scripts.results import provenance
from yade_scripts.running import queue

KINDS = {"charts": charts, "maps": maps}
MOST_FAILURES = 100  # of one chart or map; more failures do not come from single measurements


def under_way(work):
    """Return the path of the file that names the measurement under way in the worker."""
    return work.folder / f"{work.name}.under-way"


class Measurements(queue.Job):
    """The worker process of one chart or map. It is started again after a measurement that ended it."""

    def __init__(self, kind, name, full, folder, **more):
        self.work = KINDS[kind].Work(name, full, pathlib.Path(folder), **more)
        settings = {"kind": kind, "name": name, "full": full, "folder": str(folder)} | more
        super().__init__("measuring/in_yade.py", ["worker", json.dumps(settings)], self.work.folder / f"{name}.log")
        self.at = under_way(self.work)
        self.at.unlink(missing_ok=True)
        self.failures, self.trouble = 0, ""

    def again(self):
        """Tell whether to start the worker again: only if a measurement ended it, which is then stored as failed, and it can begin at all."""
        if (code := self.process.returncode) == 0:
            return False
        self.failures += 1
        if code == 1 or not self.at.exists() or self.failures > MOST_FAILURES:  # 1: an exception, so a mistake in the code that measures
            self.trouble = f"its worker ended with {code}; the end of {self.log}:\n{self.said()}"
            return False
        late = code in (-signal.SIGPROF, -signal.SIGALRM)
        reason = f"YADE ended by {signal.Signals(-code).name}" if code < 0 else f"YADE ended with {code}"
        if late:
            reason = f"took more than {self.work.limit:g} s"
        self.work.failed(self.at.read_text(encoding="utf-8"), reason, late)
        self.at.unlink()
        return True

    def outcome(self):
        return self.trouble or "measured"


@commands.command("measuring")
def main(arguments=None):
    parser = commands.parser(__doc__, prog="python3 -m yade_scripts.measuring")
    commands.add_extent(parser)
    parser.add_argument("--only", nargs="+", metavar="NAME", default=(), help="these scenes and maps")
    parser.add_argument("--series", metavar="BEGINNING", help="no maps, and only the series of settings whose names begin so")
    options = commands.add(parser, "--jobs", "--results").parse_args(arguments)
    broken = []
    kinds, more = ({"charts": charts}, {"series": options.series}) if options.series else (KINDS, {})
    known = {name: kind for kind, module in kinds.items() for name in module.names(broken)}
    for message in broken:
        print(f"measuring: {message}", file=sys.stderr)
    if unknown := [name for name in options.only if name not in known]:
        raise ParameterError(f"there is no chart or map of {', '.join(unknown)}; there are {', '.join(known)}")
    results.make(options.results)
    jobs = [Measurements(known[name], name, options.full, options.results, **more) for name in options.only or known]
    jobs.sort(key=lambda job: -job.work.limit)  # the longest first
    queue.run(jobs, options.jobs)
    for work in [job.work for job in jobs]:
        stored = [store.get(work.folder, path.stem) for path in work.folder.glob(f"{work.name}-*.h5")]
        if doubt := provenance.doubt({facts["git_commit"] for facts in stored if facts}):
            print(f"measuring: {work.name}: some measurements {doubt}", file=sys.stderr)
    troubled = [job for job in jobs if job.trouble]
    for job in troubled:
        print(f"measuring: {job.work.name}: {job.trouble}", file=sys.stderr)
    return 1 if troubled or broken else 0


if __name__ == "__main__":
    queue.end_by_signals("measuring")
    sys.exit(main())
