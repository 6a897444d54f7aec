"""The contact solvers for any Python: no YADE is needed, and bodies may be of any kind.

    from cd_engine import core
    problem = core.read_problem("problem.hdf5")             # FCLIB, Siconos's text, or bodies
    report = core.solve(problem, tolerance=1e-8)
    report.status, report.iterations, core.residual(problem, report.impulses)

A `Problem` has W, q and mu. A `BodyProblem` has bodies and contacts; it is faster to sweep, and its delassus() returns the `Problem`.
A `SpaceBodyProblem` has bodies that move in space.
The problem is Signorini's contact with Coulomb's friction, for the n contacts of a time step: find impulses p with

    u = W p + q,    0 <= u_n _|_ p_n >= 0,    |p_t| <= mu p_n,    p_t = -mu p_n u_t/|u_t| where a contact slides.

In the plane p_t and u_t are numbers, in space they have two components.
"""
from .files import read_problem, write_problem
from .files.body_problem import BodyProblem
from .files.problem import Problem
from .files.space_bodies import SpaceBodyProblem
from .solve import Report, bytes_of_a_sweep, instruction_sets, methods, residual, residual_max, solve, use_instruction_set

__all__ = ["BodyProblem", "Problem", "Report", "SpaceBodyProblem", "bytes_of_a_sweep", "instruction_sets", "methods", "read_problem", "residual",
           "residual_max", "solve", "use_instruction_set", "write_problem"]
