"""Logging the record of a run to MLflow: the parameters, scores, claims and costs that its pages can sort and compare."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from walklab.errors import InputError
from walklab.runs.checksums import sha256
from walklab.runs.comparison import flat
from walklab.runs.io import read_record
from walklab.runs.record import SCORE_KEYS, SCORE_VALUES

EXPERIMENT = "walklab"
RECORD_TAG = "walklab.record"
LONGEST_PARAMETER = 500  # characters, a limit of MLflow's stores
SENT = ("*.csv", "*.json", "*.html", "*.pdf", "figures/*.png")


def track(run: str | Path, uri: str | None = None) -> tuple[str, bool]:
    """Log a finished run once.

    Parameters
    ----------
    run : the run's folder
    uri : MLflow tracking URI; by default an SQLite file beside the run's folder, with its artifacts beside that

    Returns
    -------
    MLflow's identifier of the run, and whether it is new there (the same record is not logged twice)

    Raises
    ------
    InputError
        If there is no record, MLflow is not installed, or the store cannot be reached.
    """
    folder = Path(run)
    record = read_record(folder)
    mlflow = _mlflow()
    store = folder.resolve().parent
    try:
        mlflow.set_tracking_uri(uri or f"sqlite:///{store / 'mlflow.db'}")
        found = mlflow.get_experiment_by_name(EXPERIMENT)
        artifacts = None if uri else (store / "mlflow-artifacts").as_uri()
        experiment = found.experiment_id if found else mlflow.create_experiment(EXPERIMENT, artifact_location=artifacts)
        identity = sha256(folder / "run.json")
        known = mlflow.search_runs([experiment], f"tags.`{RECORD_TAG}` = '{identity}'", output_format="list")
        if known:
            return known[0].info.run_id, False
        with mlflow.start_run(experiment_id=experiment, run_name=str(record["run"])) as started:
            mlflow.set_tags({RECORD_TAG: identity, **tags(record)})
            mlflow.log_params({key: str(value)[:LONGEST_PARAMETER] for key, value in flat(record["config"]).items()})
            mlflow.log_metrics(metrics(record))
            for path in sorted(found for pattern in SENT for found in folder.glob(pattern)):
                mlflow.log_artifact(str(path), path.parent.relative_to(folder).as_posix().removeprefix(".") or None)
            return started.info.run_id, True
    except mlflow.exceptions.MlflowException as error:
        raise InputError(f"{uri or store}: cannot be used as tracking store ({error})") from error


def tags(record: Mapping[str, Any]) -> dict[str, str]:
    """Commit, machine and versions, as MLflow's tags."""
    commit = record["commit"]
    return {
        "mlflow.source.git.commit": str(commit.get("id", "")),
        "dirty": str(commit.get("dirty", "")),
        "recorded": str(record.get("recorded", "")),
        **{f"machine.{name}": str(value) for name, value in record.get("machine", {}).items()},
        **{f"version.{name}": str(record["versions"].get(name, "")) for name in ("walklab", "numpy", "numba", "scipy")},
    }


def metrics(record: Mapping[str, Any]) -> dict[str, float]:
    """Every number of a record under a name that MLflow accepts."""
    found: dict[str, float] = {}
    for claim in record.get("claims", []):
        if claim["ours"] is not None:
            found[_name("claim", claim["id"])] = float(claim["ours"])
    for claim in record.get("claims", []):
        counted = _name("claims", claim["verdict"])
        found[counted] = found.get(counted, 0.0) + 1.0
    for row in record.get("scores", []):
        key = [str(row[name]) for name in SCORE_KEYS if row.get(name)]
        found |= {_name(measure, *key): float(row[measure]) for measure in SCORE_VALUES if row.get(measure) is not None}
    for stage in record["stages"]:
        name = _name("wall_s", stage["stage"])
        found[name] = found.get(name, 0.0) + stage["wall_s"]
    return found | {_name("total", name): float(value) for name, value in record.get("totals", {}).items()}


def _name(*parts: str) -> str:
    return "/".join(re.sub(r"[^\w .-]+", "_", part).strip("_ ") for part in parts)


def _mlflow() -> Any:
    # Nothing is to leave this machine but what goes to the store that the user named.
    os.environ.setdefault("MLFLOW_DISABLE_TELEMETRY", "true")
    try:
        import mlflow
    except ImportError:
        raise InputError("mlflow is not installed; use `make track`, or install the extra walklab[tracking]") from None
    return mlflow
