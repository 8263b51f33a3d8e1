"""The file of a calibration."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

from walklab.errors import InputError
from walklab.evaluation.calibration import Calibration
from walklab.evaluation.pace import PaceEffect
from walklab.storage import read_json, write_json


def write_calibration(calibration: Calibration, path: str | Path) -> None:
    """JSON of all fields."""
    write_json({"format": "walklab calibration", "version": 1, **asdict(calibration)}, path)


def read_calibration(path: str | Path) -> Calibration:
    """Calibration written by :func:`write_calibration`; InputError for any other file."""
    content = read_json(path)
    try:
        if content.pop("format") != "walklab calibration" or content.pop("version") != 1:
            raise ValueError("another format or version")
        return Calibration(**{**content, "pace": PaceEffect(**content["pace"])})
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}: not a calibration ({error}); run calibrate_model again") from error
