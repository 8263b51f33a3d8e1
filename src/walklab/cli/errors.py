"""How the command line speaks of bad input: one line, exit code 2."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from typing import Any, TypeVar

import typer

from walklab.errors import InputError

Command = TypeVar("Command", bound=Callable[..., None])

BAD_INPUT = 2


def plain_errors(command: Command) -> Command:
    """Bad input ends in one line and exit code 2; warnings are one line each."""

    @functools.wraps(command)
    def wrapped(*args: Any, **kwargs: Any) -> None:
        try:
            with warnings.catch_warnings(record=True) as told:
                warnings.simplefilter("always", UserWarning)
                command(*args, **kwargs)
        except (InputError, OSError) as error:
            typer.echo(f"walklab: {' '.join(str(error).split())}", err=True)
            raise typer.Exit(BAD_INPUT) from None
        for line in dict.fromkeys(str(warning.message) for warning in told if issubclass(warning.category, UserWarning)):
            typer.echo(f"walklab: {line}", err=True)

    return wrapped  # type: ignore[return-value]
