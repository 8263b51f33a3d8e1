"""The scoring rules are the library's, whether its kernels are compiled or not."""

from __future__ import annotations

import subprocess
import sys

SAME = """
import sys
import numpy as np

rng = np.random.default_rng(1)
observed, members = rng.gamma(4.0, size=50), rng.gamma(4.0, size=(50, 200))
from walklab.evaluation.scoring_rules import scoring_rules

ours = scoring_rules()
quick = ours.crps_ensemble(observed, members, estimator="qd"), ours.crps_lognormal(observed, 1.0, 0.4)
assert ours.core.crps.estimator_gufuncs is None, "the kernels were compiled"
for name in [name for name in sys.modules if name.startswith("scoringrules")]:
    del sys.modules[name]
import scoringrules

assert scoringrules.core.crps.estimator_gufuncs is not None, "the library itself is as it was"
slow = scoringrules.crps_ensemble(observed, members, estimator="qd"), scoringrules.crps_lognormal(observed, 1.0, 0.4)
np.testing.assert_allclose(quick, slow, rtol=1e-12)
"""


def test_rules_need_no_compiling_and_give_the_same_numbers():
    done = subprocess.run([sys.executable, "-c", SAME], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
