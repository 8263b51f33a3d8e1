"""``walklab compare``, ``track``, ``crate`` and ``check``: what is done with runs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from walklab.cli.errors import plain_errors, printable
from walklab.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

Run = Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a finished run, such as results/steering.")]

DAMAGED = 1  # exit code


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    for command in (compare, track, crate, check):
        app.command()(command)


@plain_errors
def compare(
    before: Annotated[Path, typer.Argument(metavar="RUN_A", help="Folder (or run.json) of a finished run.")],
    after: Annotated[Path, typer.Argument(metavar="RUN_B", help="Folder (or run.json) of another.")],
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Also draw the comparison, as this PNG.")] = None,
    all_rows: Annotated[bool, typer.Option("--all", help="Every row, not only the largest changes.")] = False,
) -> None:
    """What changed from one run to another: configuration, code, versions, products, claims, scores, cost."""
    from walklab.runs.comparison import compare as compared
    from walklab.runs.io import read_record

    if output is not None and output.suffix.lower() != ".png":
        raise InputError(f"{output}: the comparison is drawn as PNG; give a name that ends in .png")
    found = compared(read_record(before), read_record(after))
    typer.echo(printable(f"before: {before} (run {found.names[0]})\nafter:  {after} (run {found.names[1]})"))
    rows = None if all_rows else 12
    moved = found.scores[found.scores["difference"] != 0].dropna(subset="difference")
    moved = moved.reindex(moved["difference"].abs().sort_values(ascending=False, kind="stable").index)
    costs = found.cost.dropna().sort_values("before", ascending=False, kind="stable")
    for title, table in (
        ("configuration", found.config),
        ("code", found.code),
        ("versions", found.versions),
        ("products, by checksum", found.products),
        (f"claims (of {len(found.claims)})", found.changed_claims.drop(columns="changed")),
        ("scores, largest change first", moved),
    ):
        _show(title, table, rows)
    _show("cost, costliest stage first (s)", costs, rows, changed=False)
    if output is not None:
        from walklab.figures.comparison import draw_comparison
        from walklab.figures.style import save_png

        save_png(draw_comparison(found.claims, found.scores, found.cost, (str(before), str(after))), output)
        typer.echo(f"\ndrawn in {output}")


@plain_errors
def track(
    run: Run,
    uri: Annotated[str | None, typer.Option(help="MLflow tracking URI; none: results/mlflow.db beside the run.")] = None,
) -> None:
    """Log a finished run to MLflow; the same record is logged once. Needs the extra "tracking" of walklab."""
    from walklab.runs.tracking import track as tracked

    identity, new = tracked(run, uri)
    typer.echo(f"{run}: {'logged' if new else 'already there'} as MLflow run {identity}")


@plain_errors
def crate(
    run: Run,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Zip file; none: RUN.crate.zip.")] = None,
    root: Annotated[Path, typer.Option(help="The checkout that the run was made with.")] = Path(),
) -> None:
    """Pack a finished run as a Workflow Run RO-Crate. Needs the extra "tracking" of walklab."""
    from walklab.runs.crate import write_crate

    target = output or run.parent / f"{run.name}.crate.zip"
    typer.echo(f"{target}: {write_crate(run, root, target)} files of {run} with the workflow and its description")


@plain_errors
def check(run: Run) -> None:
    """Look for damaged, missing and half-written files in a run; say what to type.

    A file of the run dated in the future (the clock went back), damaged or not, is dated to now: Snakemake goes by dates.
    """
    from walklab.runs.checksums import date_back, inspect

    found = inspect(run)
    for damage in found.damaged:
        typer.echo(f"{damage.path}: {damage.reason}")
    for path in found.missing:
        typer.echo(f"{path}: missing")
    if found.temporary:
        typer.echo(f"{found.temporary} temporary files were deleted after use, as they should be")
    for path in found.half_written:
        typer.echo(f"{path}: left by a job that was killed; the next one that writes this file removes it")
    for path in date_back(run):
        typer.echo(f"{path}: was dated in the future, now dated today")
    if found.damaged or found.missing:
        again = " ".join(dict.fromkeys([*(damage.rebuild for damage in found.damaged), *found.missing]))
        typer.echo(f"To rebuild (with the --configfile of this run): .venv/bin/snakemake --forcerun {again}")
        raise typer.Exit(DAMAGED)
    typer.echo(f"{found.checked} products are what their jobs wrote")


def _show(title: str, table: pd.DataFrame, rows: int | None, changed: bool = True) -> None:
    if table.empty:
        typer.echo(f"\n{title}: {'no change' if changed else 'nothing that both runs have'}")
        return
    typer.echo(f"\n{title}: {f'{len(table)} changed' if changed else f'{len(table)} stages'}")
    shown = table if rows is None else table.head(rows)
    typer.echo(printable(shown.to_string(index=False, float_format=lambda value: f"{value:.4g}", max_colwidth=60)))
    if len(shown) < len(table):
        typer.echo(f"... and {len(table) - len(shown)} more (--all)")
