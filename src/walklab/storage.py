"""Primitives for reading and writing files: atomic, checked, and free of pickled objects.

Every writer fills a temporary file beside its target and renames it, so that a reader
never sees half a file. Each room's ``io.py`` builds its own products on these.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from walklab.errors import InputError

TEMPORARY_NAME = re.compile(r"\..+\.[a-z0-9_]{8}(\.[^.]+)?")  # a dot, the target's stem, what mkstemp adds, the suffix


@contextlib.contextmanager
def atomic_path(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path in the same folder; rename it to ``path`` if the block succeeds."""
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.stem}.", suffix=target.suffix)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        # mkstemp creates files only their owner can read; results are meant to be shared.
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(target)
        # A killed writer cannot tidy up behind itself; the next one to write the same file does.
        for leftover in target.parent.glob(f".{target.stem}.????????{target.suffix}"):
            leftover.unlink(missing_ok=True)
    finally:
        temporary.unlink(missing_ok=True)


def is_temporary(path: str | Path) -> bool:
    """Whether a file is named as :func:`atomic_path` names what is not whole yet."""
    return TEMPORARY_NAME.fullmatch(Path(path).name) is not None


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def write_table(frame: pd.DataFrame, path: str | Path) -> None:
    """Write a table as Parquet (or CSV where the suffix says so)."""
    with atomic_path(path) as temporary:
        if Path(path).suffix == ".csv":
            frame.to_csv(temporary, index=False, float_format="%.6g")
        else:
            frame.to_parquet(temporary, index=False, compression="zstd")


def read_table(path: str | Path) -> pd.DataFrame:
    """Read a Parquet or CSV table.

    Raises
    ------
    InputError
        If the file is missing, empty or not a table.
    """
    source = Path(path)
    if not source.is_file():
        raise InputError(f"{source}: no such file; check the path in the configuration")
    try:
        return pd.read_csv(source) if source.suffix == ".csv" else pd.read_parquet(source)
    except Exception as error:
        reason = str(error).strip().splitlines()[0]
        raise InputError(f"{source}: not a readable {source.suffix or 'Parquet'} table ({reason}); write it again") from error


def write_json(value: Any, path: str | Path) -> None:
    """Write plain data as JSON; NaN is refused, since JSON has no such number."""
    with atomic_path(path) as temporary:
        temporary.write_text(json.dumps(value, indent=2, allow_nan=False) + "\n")


def read_json(path: str | Path) -> Any:
    """Read a JSON file."""
    try:
        return json.loads(Path(path).read_text())
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: not a readable JSON file ({error}); write it again") from error


def write_text(text: str, path: str | Path) -> None:
    """Write a text file."""
    with atomic_path(path) as temporary:
        temporary.write_text(text)


def write_dataset(dataset: Any, path: str | Path) -> None:
    """Write an ``xarray.Dataset`` as NetCDF-4, compressed."""
    encoding = {name: {"zlib": True, "complevel": 1} for name in dataset.data_vars}
    with atomic_path(path) as temporary:
        dataset.to_netcdf(temporary, engine="h5netcdf", encoding=encoding)


def read_dataset(path: str | Path) -> Any:
    """Read an ``xarray.Dataset`` into memory and close the file."""
    import xarray as xr  # late: a process that only samples must not pay for this import

    try:
        return xr.load_dataset(path, engine="h5netcdf")
    except Exception as error:
        raise InputError(f"{path}: not a readable NetCDF file ({error}); write it again") from error


def write_tensors(tensors: Mapping[str, np.ndarray], header: Mapping[str, Any], path: str | Path) -> None:
    """Write named arrays and a JSON header as one safetensors file."""
    from safetensors.numpy import save_file

    contiguous = {name: np.ascontiguousarray(values) for name, values in tensors.items()}
    with atomic_path(path) as temporary:
        save_file(contiguous, temporary, metadata={"walklab": json.dumps(header, allow_nan=False)})


def read_tensors(path: str | Path) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Read the arrays and the JSON header of a safetensors file.

    Raises
    ------
    InputError
        If the file is no safetensors file or has no walklab header.
    """
    from safetensors import SafetensorError, safe_open

    try:
        with safe_open(path, framework="numpy") as file:
            metadata = file.metadata() or {}
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 (not a dict)
        return tensors, json.loads(metadata["walklab"])
    except (OSError, SafetensorError, KeyError, json.JSONDecodeError) as error:
        raise InputError(f"{path}: not a walklab model file ({error}); train the model again") from error
