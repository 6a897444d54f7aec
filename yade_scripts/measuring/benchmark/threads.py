"""Measures how much faster threads make a step: packings of step.py at rest, one to as many threads as there are cores, in turn.

    yade -n -x yade_scripts/measuring/in_yade.py benchmark.threads '{"rows": 20, "columns": 2000, "tolerance": 1e-4, "steps": 100}'

Times are wall-clock times, medians over step.RUNS runs of each number of threads.
"""
import os

from yade_scripts.measuring.benchmark import step

COUNTS = (1, 2, 4, 8, 16)  # threads


def main(rows, columns, tolerance, steps):
    step.build(rows, columns, "built")
    engine, cores = step.settle(tolerance), len(os.sched_getaffinity(0))
    costs = step.costs(engine, max(2, steps // step.RUNS), [threads for threads in COUNTS if threads <= cores])
    wall, solver = costs[1][1:3]
    return [{"status": "measured", "disks": rows * columns, "contacts": engine.contacts, "tolerance": tolerance, "cores": cores, "threads": threads,
             "sweeps_a_step": cost[3], "ns_a_contact": 1e9 * cost[1] / engine.contacts, "step_speedup": wall / cost[1],
             "solver_speedup": solver / cost[2]} for threads, cost in costs.items()]
