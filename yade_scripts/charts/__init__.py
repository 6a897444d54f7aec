"""The runs behind the charts of speed against accuracy: which settings (settings.py), how one is measured in YADE (measure.py), what is
kept of it (records.py), and all of them, a few at a time, past every crash (run.py)."""
