"""The examples with other simulators, run where those are installed: ``pip install "walklab[simulators]"``, or in
``.venv/peers``, which ``make test-all`` and ``make bench`` set up."""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"


@pytest.mark.parametrize(("example", "package"), [("orca_speeds", "pyrvo"), ("jupedsim_speeds", "jupedsim")])
def test_agents_walk_at_the_speeds_that_the_model_drew(example, package, monkeypatch, capsys):
    # At the end of the path: whatever the project has itself is not replaced.
    monkeypatch.setattr(sys, "path", [*sys.path, *map(str, sorted((ROOT / ".venv/peers").glob("lib/python*/site-packages")))])
    absent = f"{package} is not installed: make .venv/peers/ready, or pip install 'walklab[simulators]'"
    pytest.importorskip(package, reason=absent, exc_type=ImportError)
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
