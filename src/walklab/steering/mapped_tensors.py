"""Opening a safetensors file without reading it: arrays are views of the memory-mapped file.

The format (https://github.com/huggingface/safetensors): eight bytes with the length n of the header, n bytes of
JSON that give each array's type, shape and place, then the arrays. It holds numbers only; nothing in it can run.
Pages are read when an array is used, and never written back.
"""

from __future__ import annotations

import json
import mmap
from pathlib import Path
from typing import Any

import numpy as np

from walklab.errors import InputError

TYPES = {"F64": np.float64, "F32": np.float32, "I64": np.int64, "I32": np.int32, "U8": np.uint8}
LARGEST_HEADER = 100_000_000  # as in the format's own reader


def open_tensors(path: str | Path) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """The arrays of a file, memory-mapped, and its JSON header.

    Raises
    ------
    InputError
        If the file is missing or damaged, or has no walklab header.
    """
    try:
        with open(path, "rb") as file:
            mapped = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_COPY)
        start = 8 + int.from_bytes(mapped[:8], "little")
        if not 8 <= start <= min(len(mapped), LARGEST_HEADER):
            raise ValueError("its header is longer than the file")
        entries = json.loads(mapped[8:start])
        header = json.loads(entries.pop("__metadata__")["walklab"])
        return {name: _view(mapped, start, name, entry) for name, entry in entries.items()}, header
    except OSError as error:
        raise InputError(f"{path}: cannot be opened ({error.strerror}); give the file of a trained model") from error
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(f"{path}: not a walklab model file ({error}); train the model again") from error


def _view(mapped: mmap.mmap, start: int, name: str, entry: dict[str, Any]) -> np.ndarray:
    kind = np.dtype(TYPES[entry["dtype"]])
    shape = tuple(int(n) for n in entry["shape"])
    first, last = (int(place) for place in entry["data_offsets"])
    count = 1
    for n in shape:
        count *= n
    if any(n < 0 for n in shape) or not 0 <= first <= last <= len(mapped) - start or last - first != count * kind.itemsize:
        raise ValueError(f"tensor {name} does not fit in the file")
    return np.frombuffer(mapped, kind, count, start + first).reshape(shape)
