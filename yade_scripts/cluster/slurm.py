"""Submits jobs to Slurm and asks for their state by the commands sbatch, squeue and scontrol. It needs no accounting database."""
import collections
import re
import shutil
import subprocess


class SlurmError(RuntimeError):
    """A command of Slurm failed; the message says which and what it said."""


def _ask(*command):
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if not done.returncode:
        return done.stdout
    said = (done.stderr or done.stdout).strip().splitlines() or [f"ended with status {done.returncode}"]
    if not re.search("controller|configuration source|DNS SRV", "\n".join(said)):
        raise SlurmError(f"{command[0]}: {' '.join(said)}")
    # If no controller is found, the command prints several lines about the search; the last line states the result.
    raise SlurmError(f"{command[0]}: {said[-1]}. No Slurm controller answers from here: ask `scontrol ping`, go to a machine of the cluster, or "
                     "run the rows on this one by yade_scripts/batch.py")


def present():
    """Tell whether jobs can be submitted from here."""
    return shutil.which("sbatch") is not None


def largest_array():
    """Return how many tasks one array job may have."""
    found = re.search(r"^MaxArraySize\s*=\s*(\d+)", _ask("scontrol", "show", "config"), re.M)
    return max(1, int(found.group(1)) - 1 if found else 1000)


def submit(name, command, tasks, output, minutes=None, at_once=None, options=()):
    """Submit an array job of `tasks` tasks with one core each. Return the job's number. minutes: time limit of a task; at_once: most tasks that run
    at the same time. Slurm puts a task whose node fails back into the queue."""
    array = f"--array=0-{tasks - 1}" + (f"%{at_once}" if at_once else "")
    limit = [f"--time={minutes}"] if minutes else []
    return _ask("sbatch", "--parsable", f"--job-name={name}", array, "--ntasks=1", "--cpus-per-task=1", "--requeue", "--open-mode=append",
                f"--output={output}", *limit, *options, f"--wrap={command}").strip().partition(";")[0]


def states(name):
    """Return {state: number of tasks} of the jobs in the queue under this name."""
    return collections.Counter(_ask("squeue", "--me", "--noheader", "--array", f"--name={name}", "--format=%T").split())


def reasons(name):
    """Return why the jobs in the queue do not run, in Slurm's words, as a sorted list."""
    said = _ask("squeue", "--me", "--noheader", f"--name={name}", "--states=PENDING", "--format=%r").split("\n")
    return sorted(set(said) - {"", "None", "Resources", "Priority"})
