"""The examples with other simulators, run where those are installed: ``pip install "walklab[simulators]"``."""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize(("example", "package"), [("orca_speeds", "pyrvo"), ("jupedsim_speeds", "jupedsim")])
def test_agents_walk_at_the_speeds_that_the_model_drew(example, package, monkeypatch, capsys):
    pytest.importorskip(package, reason=f"{package} is not installed: pip install 'walklab[simulators]'", exc_type=ImportError)
    monkeypatch.syspath_prepend(EXAMPLES)
    module = importlib.import_module(example)
    wished, walked = module.main([])
    assert np.ptp(wished) > 0.02
    assert wished.min() > 0.15
    # All of them walked freely, so as far as their speed takes them: as far as the fastest, in proportion.
    fastest = np.argmax(wished)
    assert walked / walked[fastest] == pytest.approx(wished / wished[fastest], rel=0.03)
    assert walked[fastest] == pytest.approx(module.WALK_M, rel=0.15)
    assert "4 agents" in capsys.readouterr().out
    sys.modules.pop("simulators", None)
