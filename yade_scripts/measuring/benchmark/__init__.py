"""What the solvers cost, measured beside Siconos's: `make bench`. See __main__.py for the pieces and the command line."""
