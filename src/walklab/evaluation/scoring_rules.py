"""The library of scoring rules, imported without compiling it."""

from __future__ import annotations

import sys
from types import ModuleType

from walklab.imports import without

# The library falls back to its numpy rules where these are missing; one it has not got (or renames) is not missed.
COMPILED = tuple(
    f"scoringrules.core.{rule}.{module}"
    for rule in ("crps", "dss", "energy", "error_spread", "interval", "kernels", "variogram")
    for module in ("_gufunc", "_gufuncs", "_gufuncs_w")
)


def scoring_rules() -> ModuleType:
    """scoringrules with numpy's arithmetic.

    It compiles some fifty functions on import, 3 to 4 s in every process that scores anything; its numpy rules give the
    same numbers in the same time and need 0.02 s. Imported late, because most rules that reach this module score nothing.
    """
    if "scoringrules" not in sys.modules:
        with without(*COMPILED):
            import scoringrules
        scoringrules.backends.set_active("numpy")
    return sys.modules["scoringrules"]
