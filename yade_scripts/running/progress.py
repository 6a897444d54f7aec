"""Progress of a long run with the time left: a bar on a terminal, otherwise a line every few seconds."""
import sys

from tqdm import tqdm

SECONDS = 5
TELLING = 0.02  # no remaining time is shown before this fraction is done: the first steps do not predict it


class Progress:
    """Shows the progress of a run; call it with the fraction done."""

    def __init__(self, title):
        terminal = sys.stderr.isatty()
        form = "{desc} {percentage:3.0f} %|{bar}| {elapsed}<{remaining}" if terminal else "{desc}: {percentage:.0f} %, {remaining} left\n"
        self.formats = form.replace("{remaining}", "?"), form
        self.bar = tqdm(total=1.0, desc=title, file=sys.stderr if terminal else sys.stdout, mininterval=0.1 if terminal else SECONDS, miniters=0,
                        bar_format=self.formats[0])
        self.begun = None  # fraction done at the first call

    def __call__(self, fraction):
        if self.begun is None:  # a resumed run begins in the middle
            self.bar.initial = self.bar.n = self.bar.last_print_n = self.begun = fraction
        if fraction - self.begun >= TELLING:
            self.bar.bar_format = self.formats[1]
        self.bar.update(fraction - self.bar.n)

    def close(self):
        self.bar.bar_format = self.formats[1]
        self.bar.close()
