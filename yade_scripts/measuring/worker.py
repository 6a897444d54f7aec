"""Measures, in one YADE process, what is missing of one chart or map. Started by `python3 -m yade_scripts.measuring`.

    yade -n -x -j 1 yade_scripts/measuring/worker.py charts stack [--full] [--results FOLDER]

A file beside the log names the measurement under way, so that a crash costs one measurement only. If a measurement exceeds its processor time,
SIGPROF ends the process; if it only waits, SIGALRM ends it after twenty times as long in real time.
"""
import pathlib
import signal
import sys

if __name__ == "__main__":
    sys.path.insert(0, str(pathlib.Path(sys.argv[0]).resolve().parents[2]))

from yade_scripts import commands
from yade_scripts.measuring import __main__ as runner


@commands.command("worker")
def main(arguments=None):
    parser = commands.parser(__doc__)
    parser.add_argument("kind", choices=list(runner.KINDS))
    parser.add_argument("name")
    commands.add_extent(parser)
    options = commands.add(parser, "--results").parse_args(arguments)
    work = runner.KINDS[options.kind].Work(options.name, options.full, pathlib.Path(options.results))
    under_way = runner.under_way(options.kind, options.name, options.results)

    def limit(seconds):
        signal.setitimer(signal.ITIMER_PROF, seconds)
        signal.alarm(int(20 * seconds))

    def begun(name, seconds):
        under_way.write_text(name, encoding="utf-8")
        limit(seconds)

    work.measure(begun)
    limit(0)
    under_way.unlink(missing_ok=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
