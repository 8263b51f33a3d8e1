"""``walklab fit``, ``sample``, ``simulate`` and ``inspect``; what is done with runs is in :mod:`walklab.cli.runs`.

What a command needs is imported when it runs, so that ``--help`` is quick and sampling loads little.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from walklab.cli import runs
from walklab.cli.errors import plain_errors
from walklab.errors import InputError

if TYPE_CHECKING:
    from walklab.steering.probabilistic import ProbabilisticModel

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Learn from captured human walks how people steer, and simulate them with it.",
)

ModelFile = Annotated[Path, typer.Argument(metavar="MODEL", help="Model file (.safetensors).", show_default=False)]
Length = Annotated[float | None, typer.Option(help="Length of the planned path, m.")]
Curvature = Annotated[float | None, typer.Option(help="Mean curvature of the planned path, 1/m.")]
Height = Annotated[float | None, typer.Option(help="Body height, m.")]
StartSpeed = Annotated[float | None, typer.Option(help="Speed at the start, m/s (models that know it).")]
Seed = Annotated[int | None, typer.Option(min=0, help="Seed of the random numbers; none: a different draw every time.")]


def _given(**dependencies: float | None) -> dict[str, float]:
    return {name: value for name, value in dependencies.items() if value is not None}


def _open(path: Path) -> ProbabilisticModel:
    from walklab.steering.probabilistic import ProbabilisticModel

    return ProbabilisticModel.load(path)


@app.command()
@plain_errors
def fit(
    walks: Annotated[Path, typer.Argument(metavar="WALKS", help="Table of positions over time, CSV or Parquet.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Model file to write.")] = Path("model.safetensors"),
    participant: Annotated[str, typer.Option(help="Column of who walked.")] = "participant",
    walk: Annotated[str, typer.Option(help="Column that tells one person's walks apart; '' if each walked once.")] = "walk",
    time: Annotated[str | None, typer.Option(help="Column of times; time_s unless --rate-hz is given.")] = None,
    rate_hz: Annotated[float | None, typer.Option(help="Frames per second, where there is no column of times.")] = None,
    x: Annotated[str, typer.Option(help="Column of x.")] = "x_m",
    y: Annotated[str, typer.Option(help="Column of y.")] = "y_m",
    height: Annotated[str, typer.Option(help="Column of body heights.")] = "height_m",
    length_unit: Annotated[str, typer.Option(help="Unit of x and y: m, cm or mm.")] = "m",
    height_unit: Annotated[str | None, typer.Option(help="Unit of the height, if another: m, cm or mm.")] = None,
    time_unit: Annotated[str, typer.Option(help="Unit of the time: s or ms.")] = "s",
    basis: Annotated[str, typer.Option(help="Interpolation of the maps: rbf (the paper's) or multilinear (fast).")] = "rbf",
    neighbours: Annotated[int, typer.Option(help="Nearest maps that are blended, or all if these are fewer.")] = 100,
    exponent: Annotated[float, typer.Option(help="Sharpness of the density; 1 is the paper's.")] = 1.0,
    entries: Annotated[int | None, typer.Option(help="Up-sample to this many maps; none: the captured ones.")] = None,
) -> None:
    """Train a model on captured walks (see docs/own-walks.md for the table).

    Walks around obstacles are not read here: every walk is taken to be in the open, so its planned path is straight and
    curvature is no dependency to learn. Where there is a scene column, use config/own.yaml or walklab.fitting.fit_walks.
    """
    from walklab.capture.own import OwnColumns
    from walklab.fitting import fit_walks
    from walklab.steering.training import TrainingSettings

    time_column = time or ("time_s" if rate_hz is None else None)
    columns = OwnColumns(participant, walk or None, time_column, x, y, height)
    settings = TrainingSettings(count=entries, basis=basis, k=neighbours, exponent=exponent)  # type: ignore[arg-type]
    units = {"length_unit": length_unit, "height_unit": height_unit, "time_unit": time_unit}
    learned = ("length", "height")
    model = fit_walks(walks, columns, settings=settings, rate_hz=rate_hz, dependencies=learned, **units)  # type: ignore[arg-type]
    model.save(output)
    typer.echo(f"{output}: {model.provenance['walks']} walks of {model.provenance['participants']} people")


@app.command()
@plain_errors
def sample(
    model: ModelFile,
    length: Length = None,
    curvature: Curvature = None,
    height: Height = None,
    start_speed: StartSpeed = None,
    size: Annotated[int, typer.Option(min=1, help="How many parameter vectors.")] = 1,
    seed: Seed = None,
) -> None:
    """Draw steering parameters for one walk, as CSV with units in the header."""
    opened = _open(model)
    given = _given(length=length, curvature=curvature, height=height, start_speed=start_speed)
    drawn = opened.sample(size=size, rng=np.random.default_rng(seed), **given)
    typer.echo(",".join(f"{name} ({unit})" if unit else name for name, unit in zip(opened.names, opened.units, strict=True)))
    for row in drawn:
        typer.echo(",".join(f"{value:.6g}" for value in row))


@app.command()
@plain_errors
def simulate(
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="Plan view (YAML): obstacles and stations, m.")],
    model: Annotated[Path, typer.Option("--model", "-m", help="Model file (.safetensors).")],
    start: Annotated[str, typer.Option("--from", help="Start: a station's name, or x,y in m.")],
    end: Annotated[str, typer.Option("--to", help="End: a station's name, or x,y in m.")],
    height: Height = None,
    draws: Annotated[int, typer.Option(min=1, help="How many variants.")] = 200,
    body_radius: Annotated[float, typer.Option(help="Radius of the body seen from above, m.")] = 0.25,
    time_limit: Annotated[float, typer.Option(help="Longest simulated time, s.")] = 60.0,
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder of variants.csv, .png and .gif.")] = Path(),
    seed: Seed = None,
    animation: Annotated[bool, typer.Option(help="Also write the animation.")] = True,
) -> None:
    """Simulate variants of one walk: a table, a picture and an animation."""
    from walklab.cli.drawing import animate_variants, draw_variants
    from walklab.geometry.plans import load_plan
    from walklab.geometry.scene import Body, State, Task
    from walklab.simulation import simulate_draws
    from walklab.storage import write_table

    plan = load_plan(scene)
    stations = {name: station.position_m for name, station in plan.stations.items()}
    task = Task(State(_place(start, stations, scene)), State(_place(end, stations, scene)))
    given: dict[str, Any] = _given(height=height)
    rng = np.random.default_rng(seed)
    body = Body(body_radius)
    walks = simulate_draws(_open(model), plan.scene, task, draws, rng, body=body, time_limit_s=time_limit, **given)
    write_table(walks.table(), output / "variants.csv")
    draw_variants(walks, plan.scene, output / "variants.png")
    if animation:
        animate_variants(walks, plan.scene, output / "variants.gif")
    low, middle, high = walks.quantiles((0.05, 0.5, 0.95))
    typer.echo(f"travel time: median {middle:.2f} s, 90 % of the variants between {low:.2f} and {high:.2f} s")
    missed, collided = int(walks.missed.sum()), int(walks.collided.sum())
    typer.echo(f"of {draws} variants {missed} missed the end and {collided} went through an obstacle; they are counted in")


def _place(text: str, stations: dict[str, tuple[float, float]], scene: Path) -> tuple[float, float]:
    if text in stations:
        return stations[text]
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        known = ", ".join(stations) or "none"
        raise InputError(f"{scene}: there is no station {text!r} (it has {known}); or give x,y in m") from None
    return x, y


@app.command()
def version() -> None:
    """The version of walklab."""
    from importlib.metadata import version as of

    typer.echo(of("walklab"))


@app.command()
@plain_errors
def inspect(
    model: ModelFile,
    check: Annotated[bool, typer.Option(help="Read the whole file and look for damage.")] = False,
) -> None:
    """What a model file holds: parameters, dependencies and their training range, settings, provenance."""
    from walklab.steering.model_file import read_model

    opened = read_model(model, check_all=check)
    captured = opened.blending.vectors[~opened.blending.is_blend]
    typer.echo(f"{model}: {len(opened.blending)} maps of {opened.interpolant.cells} cells, {len(captured)} of captured walks")
    for axis in opened.space.axes:
        held = f", held at {opened.fixed[axis.name]:g}" if axis.name in opened.fixed else ""
        typer.echo(
            f"parameter   {axis.name} ({axis.unit}): {axis.values[0]:g} to {axis.values[-1]:g}, {len(axis.values)} values{held}"
        )
    for name, unit, column in zip(opened.dependencies, opened.dependency_units, captured.T, strict=True):
        typer.echo(f"dependency  {name} ({unit}): trained {column.min():.4g} to {column.max():.4g}")
    basis = opened.interpolant.name
    kernel = f" ({getattr(opened.interpolant, 'kernel', '')})" if basis == "rbf" else ""
    typer.echo(f"settings    basis {basis}{kernel}, k {opened.k}, weights {opened.weights}, exponent {opened.exponent:g}")
    for name, value in opened.provenance.items():
        typer.echo(f"provenance  {name}: {value}")
    if check:
        typer.echo("checked: every number is finite, every map positive somewhere")


@app.command()
@plain_errors
def migrate(
    model: ModelFile,
    output: Annotated[Path, typer.Option("--output", "-o", help="Model file to write.")],
) -> None:
    """Bring a model file of an earlier version up to the present one."""
    from walklab.steering.model_migration import migrate_model

    typer.echo(f"{output}: migrated from version {migrate_model(model, output)}")


runs.register(app)


def main() -> None:
    """Entry point of the command."""
    app(prog_name="walklab")


if __name__ == "__main__":
    main()
