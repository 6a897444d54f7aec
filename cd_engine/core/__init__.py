"""The contact solvers for any Python: no YADE is needed, and bodies may be of any kind.

    from cd_engine import core
    problem = core.read_problem("problem.hdf5")             # FCLIB, or Siconos's text
    report = core.solve(problem, tolerance=1e-8)
    report.status, report.iterations, core.residual(problem, report.impulses)

A problem is the one of Signorini's contact with Coulomb's friction in the plane, for n contacts of a time step: find impulses p with

    u = W p + q,    0 <= u_n _|_ p_n >= 0,    |p_t| <= mu p_n,    p_t = -mu p_n u_t/|u_t| where a contact slides.
"""
from .fclib import write_problem
from .problem import Problem
from .read import read_problem
from .solve import Report, methods, residual, solve

__all__ = ["Problem", "Report", "methods", "read_problem", "residual", "solve", "write_problem"]
