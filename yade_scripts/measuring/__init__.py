"""Measures what the methods cost and where they fail: charts of speed against accuracy, maps of stability, benchmark, regression."""
