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


def printable(text: str) -> str:
    """Text of a file as it may reach a terminal: control characters, which could command it, are written out."""
    return "".join(c if c.isprintable() or c == "\n" else ascii(c)[1:-1] for c in text)


def plain_errors(command: Command) -> Command:
    """Bad input ends in one line and exit code 2; warnings are one line each."""

    @functools.wraps(command)
    def wrapped(*args: Any, **kwargs: Any) -> None:
        try:
            with warnings.catch_warnings(record=True) as told:
                warnings.simplefilter("always", UserWarning)
                command(*args, **kwargs)
        except (InputError, OSError) as error:
            typer.echo(f"walklab: {printable(' '.join(str(error).split()))}", err=True)
            raise typer.Exit(BAD_INPUT) from None
        except MemoryError:
            typer.echo("walklab: not enough memory for this; ask for fewer draws, or for less time", err=True)
            raise typer.Exit(BAD_INPUT) from None
        for line in dict.fromkeys(str(warning.message) for warning in told if issubclass(warning.category, UserWarning)):
            typer.echo(f"walklab: {printable(line)}", err=True)

    return wrapped  # type: ignore[return-value]
