"""What is raised when the user's input cannot be used."""

from __future__ import annotations


class InputError(Exception):
    """Bad input, in one sentence for the user.

    The sentence says what is wrong, where (file, line, element id) and what to do. The command line
    prints it without a traceback and exits with 2.
    """


class HarmError(Exception):
    """A result that is not what it should be and was therefore not written, in one sentence."""
