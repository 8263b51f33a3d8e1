"""The scaling figure shows the exponents it was given."""

import numpy as np
import pandas as pd
import pytest

from walklab.errors import InputError
from walklab.figures.scaling import AXES, scaling


def costs(exponent: float) -> pd.DataFrame:
    value = np.array([10.0, 100.0, 1000.0])
    rows = {"value": value, "cost_s": 1e-3 * value**exponent, "unit": "s", "exponent": exponent}
    return pd.concat([pd.DataFrame({"quantity": name, **rows}) for name in AXES], ignore_index=True)


def test_a_panel_per_quantity_whose_fitted_line_has_the_stated_slope():
    figure = scaling(costs(0.7))
    assert len(figure.axes) == len(AXES)
    for ax in figure.axes:
        fitted = next(line for line in ax.lines if line.get_label() == "fitted 0.70")
        x, y = fitted.get_data()
        assert np.polyfit(np.log(x), np.log(y), 1)[0] == pytest.approx(0.7)


def test_a_missing_column_is_named():
    with pytest.raises(InputError, match="exponent"):
        scaling(costs(1.0).drop(columns="exponent"))
