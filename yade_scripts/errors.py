"""The errors that a user can cause; commands report them in one sentence. Imports nothing of this project, so that every module can import it."""


class ParameterError(ValueError):
    """A row cannot be run; the message names the parameter, its value, and the allowed values."""


class ResultError(Exception):
    """A result file cannot be used. The message states which file, what is wrong, and what to do."""

    def __init__(self, path, what, remedy=""):
        super().__init__(f"{path}: {what}" + f"; {remedy}" * bool(remedy))
        self.what, self.remedy = what, remedy


class NoRunError(ResultError):
    """The file does not say that it is the result of a run."""
