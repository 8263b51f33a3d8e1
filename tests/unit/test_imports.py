"""Modules can be kept out of an import, and come back afterwards."""

from __future__ import annotations

import subprocess
import sys

import pytest

from walklab.imports import without

VALIDATED = """
import sys
import pandas as pd
import pandera.pandas as pa
from walklab.capture.walks import check

check(pd.DataFrame({"x": [1.0]}), pa.DataFrameSchema({"x": pa.Column(float)}), "made up")
assert "hypothesis" not in sys.modules, "pandera loaded it"
import hypothesis
"""


def test_what_is_kept_out_cannot_be_imported_and_then_can():
    sys.modules.pop("colorsys", None)
    with without("colorsys"), pytest.raises(ImportError):
        import colorsys
    import colorsys

    assert colorsys.rgb_to_hsv(1.0, 1.0, 1.0) == (0.0, 0.0, 1.0)


def test_what_is_loaded_already_stays():
    import json

    with without("json"):
        import json as again
    assert again is json


def test_checking_a_table_does_not_load_the_library_that_makes_up_tables():
    done = subprocess.run([sys.executable, "-c", VALIDATED], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
