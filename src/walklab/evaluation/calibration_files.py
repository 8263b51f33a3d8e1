"""The file of a calibration."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from walklab.errors import InputError
from walklab.evaluation.calibration import Calibration
from walklab.steering.learned import Pace
from walklab.steering.pace import PaceEffect, Trend
from walklab.steering.sharpness import SharpnessLaw
from walklab.storage import read_json, write_json

VERSION = 2


def write_calibration(calibration: Calibration, path: str | Path) -> None:
    """JSON of all fields."""
    write_json({"format": "walklab calibration", "version": VERSION, **asdict(calibration)}, path)


def read_calibration(path: str | Path) -> Calibration:
    """Calibration written by :func:`write_calibration`; InputError for any other file."""
    content = read_json(path)
    try:
        if content.pop("format") != "walklab calibration" or content.pop("version") != VERSION:
            raise ValueError("another format or version")
        pace = dict(content["pace"])
        # JSON knows no tuples.
        fields = pace["trend"].items()
        trend: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in fields}
        pace |= {"trend": Trend(**trend), "effect": PaceEffect(**pace["effect"]), "ignored": tuple(pace["ignored"])}
        return Calibration(SharpnessLaw(**content["law"]), content["bare_exponent"], Pace(**pace))
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}: not a calibration ({error}); run calibrate_model again") from error
