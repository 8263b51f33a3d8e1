"""The one error that a user is meant to read."""


class InputError(ValueError):
    """Bad input: one line that names the file, key, column or row and what to do about it."""
