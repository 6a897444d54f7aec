"""Progress of a long run with the time left: a bar on a terminal, otherwise a line every few seconds."""
import sys
import time

from tqdm import tqdm

SECONDS = 5


def _clock(seconds):
    minutes, seconds = divmod(round(seconds), 60)
    return f"{minutes} min {seconds} s" if minutes else f"{seconds} s"


class Bar:
    """On a terminal."""

    def __init__(self, title):
        self.bar = tqdm(total=100, desc=title, unit="%", bar_format="{desc} {percentage:3.0f}%|{bar}| {elapsed}<{remaining}")

    def __call__(self, fraction):
        self.bar.update(100 * fraction - self.bar.n)

    def close(self):
        self.bar.close()


class Lines:
    """In a log."""

    def __init__(self, title):
        self.title, self.started, self.said = title, time.monotonic(), time.monotonic()
        self.first = None  # fraction that a resumed run begins with

    def __call__(self, fraction):
        now = time.monotonic()
        self.first = fraction if self.first is None else self.first
        if fraction > self.first and now - self.said >= SECONDS:
            self.said = now
            left = (now - self.started) * (1 - fraction) / (fraction - self.first)
            print(f"{self.title}: {100 * fraction:.0f} %, {_clock(left)} left", flush=True)

    def close(self):
        pass


def progress(title):
    """A callable of the fraction done, with close()."""
    return (Bar if sys.stderr.isatty() else Lines)(title)
