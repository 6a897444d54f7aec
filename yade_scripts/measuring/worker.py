"""Measures, in one YADE process, what is missing of one chart or map. Started by `python3 -m yade_scripts.measuring`.

A file beside the log names the measurement under way, so that a crash costs one measurement only. If a measurement exceeds its processor time,
SIGPROF ends the process; if it only waits, SIGALRM ends it after twenty times as long in real time.
"""
import pathlib
import signal
import sys

from yade_scripts import commands
from yade_scripts.measuring import __main__ as runner, maps
from yade_scripts.measuring.charts import measure

MEASURE = {"charts": measure.left, "maps": maps.Work.measure}


def main(kind, name, full, folder, **more):
    """Measure what is missing of the chart or map `name` in the folder of results. more: of the chart's Work."""
    work = runner.KINDS[kind].Work(name, full, pathlib.Path(folder), **more)
    under_way = runner.under_way(work)

    def limit(seconds):
        signal.setitimer(signal.ITIMER_PROF, seconds)
        signal.alarm(int(20 * seconds))

    def begun(name, seconds):
        limit(0)  # of the measurement before; it must not end the process while the file is written
        under_way.write_text(name, encoding="utf-8")
        limit(seconds)

    try:
        MEASURE[kind](work, begun)
    except OSError as error:
        limit(0)
        sys.exit(f"{error}; {commands.cure(error)} and start it again")
    limit(0)
    under_way.unlink(missing_ok=True)
