"""The study of several populations: the same rules, nothing computed twice, resumable."""

import os
import shutil
import signal
import time

import pandas as pd
import pytest

pytestmark = pytest.mark.workflow

TWO = ("--cores", "2", "--configfile", "tests/workflow/tiny.yaml", "--config", "replicates=2")
ENDS = {"check_claims", "count_claims", "pool_scores", "draw_replicates", "record_run"}


def planned(output):
    """Rule -> number of jobs, from the table of a dry run."""
    lines = output.split("Job stats")[1].split("Reasons")[0].splitlines()
    counted = [line.rsplit(maxsplit=1) for line in lines if line.strip() and line.split()[-1].isdigit()]
    return {name.strip().replace(" ", "_"): int(count) for name, count in counted}


def test_the_single_studys_population_is_none_of_them(finished_copy):
    # Models were designed on it, so all populations are new.
    jobs = planned(finished_copy.run("--dry-run", *TWO))
    assert set(jobs) >= ENDS
    for rule, twice in (("draw_participants", 2), ("fit_static", 2), ("check_claims", 2), ("record_scenario", 4)):
        assert jobs[rule] == twice
    assert not {name for name in jobs if name.startswith(("draw_fig", "ablate"))}


@pytest.fixture(scope="module")
def killed_and_resumed(finished, tmp_path_factory):
    """Two populations, killed on their way and resumed: the project, and when its finished files were written."""
    folder = tmp_path_factory.mktemp("replicates") / "copy"
    shutil.copytree(finished.folder, folder, copy_function=shutil.copy2)
    project = type(finished)(folder)
    process = project.start(*TWO)
    results = folder / "results/tiny"
    deadline = time.monotonic() + 240
    while time.monotonic() < deadline and not list(results.glob("[12]/build_space/blending_space.nc")):
        assert process.poll() is None, process.communicate()[0][-4000:]
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    assert not list(results.glob("[12]/score_forecasts/scores.csv")), "killed too late to test anything"
    kept = {path: path.stat().st_mtime_ns for path in results.glob("[12]/score_maps/*/maps.nc")}
    project.run("--unlock", *TWO)
    project.run(*TWO, "--rerun-incomplete")
    return project, kept


def test_a_killed_run_of_populations_resumes_and_redoes_nothing(killed_and_resumed):
    project, kept = killed_and_resumed
    assert kept
    assert all(path.stat().st_mtime_ns == written for path, written in kept.items())
    assert "Nothing to be done" in project.run("--dry-run", *TWO)
    more = planned(project.run("--dry-run", *TWO[:-1], "replicates=3"))
    assert more["draw_participants"] == more["score_forecasts"] == 1, "a third population needs only its own jobs"


def test_populations_differ_and_claims_and_scores_count_both(killed_and_resumed, finished):
    results = killed_and_resumed[0].folder / "results/tiny"
    first, second = (pd.read_parquet(results / f"{number}/draw_participants/participants.parquet") for number in (1, 2))
    single = pd.read_parquet(finished.folder / "results/tiny/0/draw_participants/participants.parquet")
    assert len(first) == len(second) == len(single)
    assert (first["height_m"] != second["height_m"]).any()
    assert (first["height_m"] != single["height_m"]).any()
    claims, alone = pd.read_csv(results / "claims.csv"), pd.read_csv(finished.folder / "results/tiny/claims.csv")
    assert list(claims["id"]) == list(alone["id"])
    assert claims["replicates"].max() == 2
    of_ablations = claims["id"].str.startswith("ablation_")
    assert of_ablations.any()
    assert (claims.loc[of_ablations, "replicates"] == 0).all()
    each = [pd.read_csv(results / f"{number}/check_claims/claims.csv").set_index("id") for number in (1, 2)]
    reproduced = sum((table["verdict"] == "reproduced").astype(int) for table in each)
    checked = claims.set_index("id").query("replicates == 2").index
    assert len(checked) > 30
    assert (claims.set_index("id").loc[checked, "reproduced"] == reproduced[checked]).all()
    scores = pd.read_csv(results / "scores.csv")
    single = [pd.read_csv(results / f"{number}/score_forecasts/scores.csv") for number in (1, 2)]
    mean = sum(table[table["hull"] == "all"].set_index(["scenario", "model"])["crps_s"] for table in single) / 2
    pooled = scores[(scores["hull"] == "all") & (scores["measure"] == "crps_s")].set_index(["scenario", "model"])["value"]
    pd.testing.assert_series_equal(pooled, mean.loc[pooled.index], check_names=False, rtol=1e-4)
    for name in ("replicated_claims", "replicated_scores"):
        assert (results / f"figures/{name}.png").stat().st_size > 5_000
