"""Exceptions, worded like the command's errors: what is wrong, where, and what to do."""


class Error(Exception):
    """Base class of all exceptions that this package raises itself."""


class InputError(Error, ValueError):
    """Wrong use or unreadable input; the command exits with code 2."""


class WorkError(Error, RuntimeError):
    """The work itself failed; the command exits with code 1."""


class SolveError(Error, ArithmeticError):
    """An acceleration does not exist, or a step cannot be solved; the message gives the index of the first such state."""
