"""Progress of a long run with the time left: a bar on a terminal, otherwise a line every few seconds."""
import sys

from tqdm import tqdm

SECONDS = 5


class Progress:
    """Called with the fraction done."""

    def __init__(self, title):
        terminal = sys.stderr.isatty()
        self.bar = tqdm(total=1.0, desc=title, file=sys.stderr if terminal else sys.stdout, mininterval=0.1 if terminal else SECONDS, miniters=0,
                        bar_format="{desc} {percentage:3.0f} %|{bar}| {elapsed}<{remaining}" if terminal else "{desc}: {percentage:.0f} %, {remaining} left\n")
        self.begun = False

    def __call__(self, fraction):
        if not self.begun:  # a resumed run begins in the middle
            self.bar.initial = self.bar.n = self.bar.last_print_n = fraction
            self.begun = True
        self.bar.update(fraction - self.bar.n)

    def close(self):
        """Say that the run has ended."""
        self.bar.close()
