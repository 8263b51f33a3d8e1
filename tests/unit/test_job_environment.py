"""An environment that is not that of the lock file is named in one line before the first job."""

import pytest

from walklab.job_environment import stale, unlike

LOCK = """\
alpha==1.0 \\
    --hash=sha256:00
    # via beta
beta-one==2.0 ; python_version >= '3' \\
    --hash=sha256:00
gamma==3.0 ; python_version < '3' \\
    --hash=sha256:00
delta[extra]==4.0 \\
    --hash=sha256:00
"""


@pytest.fixture
def root(tmp_path):
    (tmp_path / "requirements.lock").write_text(LOCK)
    return tmp_path


def test_what_the_lock_wants_here_is_compared_with_what_is_installed(root):
    lock = root / "requirements.lock"
    assert unlike(lock, {"alpha": "1.0", "beta-one": "2.0", "delta": "4.0"}) == []
    assert unlike(lock, {"alpha": "1.1", "beta-one": "2.0"}) == ["alpha==1.0", "delta==4.0"]


def test_the_checkouts_own_environment_is_told_to_be_stale(root):
    told = stale(root, root / ".venv")
    assert "alpha==1.0, beta-one==2.0, delta==4.0" in told
    assert "make --always-make .venv/ready" in told
    assert "\n" not in told


def test_another_environment_is_left_alone(root):
    assert stale(root, root / "other") == ""
