"""Measures the cost of the contact solvers beside that of Siconos: `make bench`. See __main__.py for the pieces and the command line."""
