"""Exceptions, with the command's words: what, where, and what to do."""


class Error(Exception):
    """Of everything that this package raises itself."""


class InputError(Error, ValueError):
    """Wrong use, or input that cannot be read: where the command exits with 2."""


class WorkError(Error, RuntimeError):
    """The work failed: where the command exits with 1."""


class SolveError(Error, ArithmeticError):
    """An acceleration does not exist, or a step cannot be solved; the message has the index of the first state."""
