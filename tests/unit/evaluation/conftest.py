"""Constructed trials, whose statistics are known."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pandas as pd
import pytest

Build = Callable[..., pd.DataFrame]


@pytest.fixture
def make_trials() -> Build:
    """Trials from the signed errors of each model; walks are dealt to the participants in turn."""

    def build(dt_s: Mapping[str, np.ndarray], participants: int = 5, captured_s: float = 2.0) -> pd.DataFrame:
        frames = []
        for model, errors in dt_s.items():
            count = len(errors)
            frame = pd.DataFrame({"walk": [f"w{i:04d}" for i in range(count)], "configuration": "c", "model": model})
            frame["participant"] = [f"p{i % participants:02d}" for i in range(count)]
            frame["captured_s"], frame["dt_s"] = captured_s, np.asarray(errors, dtype=float)
            frame["simulated_s"] = frame["captured_s"] + frame["dt_s"]
            frames.append(frame.assign(abs_dt_s=frame["dt_s"].abs(), arrival="arrived", metric_s=0.1, inside_hull=True))
        return pd.concat(frames, ignore_index=True)

    return build
