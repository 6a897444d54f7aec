"""Measures the cost of one sweep per contact, by size, kind of sweep and instruction set, beside Siconos's and the bound set by memory.

Sizes: packings of 400 and 4000 disks, and 10 and 200 copies of the larger one (tiled); 200 copies have 1.5 million contacts, which fit no cache.
The processor time of a sweep is the difference between many and few sweeps of one solution, in which everything else cancels. The bound is the
number of bytes that a sweep has to read and write, over the bandwidth of a += b on long arrays, measured between the sweeps. a += b moves 24 bytes a
number, since no cache line is read only to be overwritten.
"""
import statistics
import time

import numpy as np

from cd_engine import core
from yade_scripts.measuring.benchmark import problems, siconos

LONG = 1 << 24        # numbers in each of the two arrays: 128 MB, four times the largest cache here
WORK = 2e7            # contacts swept in a timing, for problems of all sizes
MOST, FEWEST = 4000, 60  # sweeps in a timing
AHEAD = 600              # sweeps with momentum in a timing; only the last sixth counts, in which the error is computed once at most


def bandwidth(a, b):
    """Return the bytes per second of a += b on one core."""
    begin = time.process_time()
    np.add(a, b, out=a)
    return 24 * len(a) / (time.process_time() - begin)


def traffic(problem, ahead):
    """Return the bytes that a sweep moves per contact if it reads every contact and body from memory once and writes what has changed once."""
    contact, before, body = core.bytes_of_a_sweep()
    impulses = 16
    bodies = body * len(np.unique(problem.pairs)) / problem.contacts
    plain = contact + impulses + 2 * bodies
    # A sweep with momentum also reads and writes the impulses and velocities of the sweep before, those of the bodies in a pass of their own.
    return plain + (2 * before + 4 * bodies if ahead else 0)


def plain(problem, sweeps):
    """Return the report of a solution by plain sweeps."""
    return core.solve(problem, fixed_iterations=sweeps)


def of_a_look(problem, sweeps):
    """Return the seconds of one look at the error: `sweeps` sweeps with looks between them, less the same without."""
    looking, blind = core.solve(problem, "nsgs", 1e-300, sweeps, trace=True), plain(problem, sweeps)
    return (looking.seconds - blind.seconds) / (len(looking.trace) - 1)  # without looks the error is computed once, at the end


def ahead(problem, sweeps):
    """Return the report of a solution by sweeps with momentum."""
    return core.solve(problem, "accelerated", 1e-300, sweeps)


def of_a_sweep(solution, problem, sweeps, first):
    """Return the seconds of one sweep: the difference between `sweeps` and the `first` of them."""
    many, few = solution(problem, sweeps), solution(problem, first)
    return (many.seconds - few.seconds) / (many.iterations - few.iterations)


def measure(folder, disks, copies, rounds, peer):
    """Return one row: ns per contact of every kind of sweep (medians over the rounds), a look and the set-up, and the bound by memory.

    The problem is `copies` copies of a packing of `disks` disks, with friction 0.5. peer: measure Siconos's sweeps of a single copy, too.
    """
    problem = problems.tiled(problems.packing(folder, disks, 1, 0.5).problem, copies)
    name = f"{copies} packings of {disks}" if copies > 1 else f"packing of {disks}"
    other = problems.crystal(4, 0.5).problem
    theirs = siconos.Peer(problem) if peer and copies == 1 else None
    sweeps = int(min(MOST, max(FEWEST, WORK / problem.contacts)))
    sets = core.instruction_sets()
    times = {key: [] for key in [f"plain_{s}" for s in sets] + ["accelerated", "look", "siconos", "setup", "setup_anew"]}
    speeds, long = [], (np.ones(LONG), np.ones(LONG))
    for _ in range(rounds):
        speeds.append(bandwidth(*long))
        for s in reversed(sets):  # the fastest comes last and stays in use
            core.use_instruction_set(s)
            times[f"plain_{s}"].append(of_a_sweep(plain, problem, sweeps, sweeps // 4))
        # Few sweeps count here, so small problems are solved repeatedly until the clock can resolve the time.
        times["accelerated"].append(statistics.mean(
            of_a_sweep(ahead, problem, AHEAD, AHEAD * 5 // 6) for _ in range(max(1, min(20, round(WORK / AHEAD / problem.contacts))))))
        times["look"].append(of_a_look(problem, FEWEST))
        # A solution of one sweep with set-up and error, of contacts as before; then after `other`, which has other contacts.
        for key, before in (("setup", problem), ("setup_anew", other)):
            plain(before, 1)
            times[key].append(plain(problem, 1).seconds)
        if theirs:
            count = max(4, sweeps // 20)
            times["siconos"].append(theirs.sweeps(np.zeros(2 * problem.contacts), count) / count)
    speed = max(speeds)  # smaller values come from other processes on the machine
    row = {"status": "measured", "problem": name, "disks": copies * disks, "contacts": problem.contacts, "sweeps": sweeps, "rounds": rounds}
    row |= {f"{key}_ns": statistics.median(taken) * 1e9 / problem.contacts for key, taken in times.items() if taken}
    row |= {"bandwidth_gb_per_s": speed / 1e9, "bytes_plain": traffic(problem, False), "bytes_accelerated": traffic(problem, True)}
    return [row | {f"bound_{kind}_ns": row[f"bytes_{kind}"] / speed * 1e9 for kind in ("plain", "accelerated")}]
