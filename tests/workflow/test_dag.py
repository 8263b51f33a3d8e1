"""The DAG as its users run it: dry, whole, sharded, edited, killed and resumed."""

import json
import os
import re
import shutil
import signal
import time
import warnings
from pathlib import Path

import pandas as pd
import pytest

from walklab import OutsideTrainingRange

pytestmark = pytest.mark.workflow

ROOT = Path(__file__).parents[2]
TINY = ("--configfile", "tests/workflow/tiny.yaml")


# What reads the comments of the sources, and what follows.
LISTING = {"list_assumptions", "render_tables", "record_run", "build_report", "all"}


def jobs(output: str) -> set[str]:
    """Names of the rules that a dry run would execute, from its table of jobs."""
    table = output.split("Job stats")[1].split("Reasons")[0] if "Job stats" in output else ""
    names = re.findall(r"^ *(\w[\w ]*?) +\d+ *$", table, flags=re.MULTILINE)
    return {name.replace(" ", "_") for name in names} - {"total"}


def edit(path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


def test_a_dry_run_of_the_papers_study_plans_every_stage(project):
    planned = jobs(project.run("--dry-run", "--cores", "2"))
    assert {
        "draw_participants",
        "score_maps",
        "build_space",
        "fit_static",
        "simulate_trials",
        "check_claims",
        "record_run",
    } <= planned
    assert "cross_validate" not in planned


def test_a_resampled_study_plans_the_same_stages_and_leaves_out_its_own_realism(project):
    folder = project.folder / "recordings"
    folder.mkdir()
    (project.folder / "claims.csv").write_text("id\n")
    chosen = "{source: {kind: resampled, path: recordings}, compare_verdicts: {other: claims.csv}, run: resampled}"
    (project.folder / "chosen.yaml").write_text(chosen)
    resampled = jobs(project.run("--dry-run", "--cores", "2", *TINY, "chosen.yaml"))
    default = jobs(project.run("--dry-run", "--cores", "2", *TINY))
    assert resampled - default == {"import_shapes", "compare_verdicts"}
    assert default - resampled == {"measure_realism", "draw_realism"}


def test_the_whole_study_leaves_every_figure_table_and_record(finished):
    results = finished.folder / "results/tiny"
    for number in (3, 4, 5, 6, 8, 9, 10, 11, 12, 13, 14, 15):
        for suffix in ("svg", "png"):
            assert (results / f"figures/fig{number:02d}.{suffix}").stat().st_size > 5_000
    realism = pd.read_csv(results / "realism.csv")
    assert {"lateral_excursion", "peak_speed"} <= set(realism["quantity"])
    assert realism["n_recorded"].sum() > 0 or realism["remark"].str.contains("WALKLAB_DATA").all()
    assert (results / "figures/realism.png").stat().st_size > 5_000
    claims = pd.read_csv(results / "claims.csv")
    assert {"id", "section", "statement", "published", "ours", "verdict", "note"} <= set(claims)
    assert len(claims) > 50
    scores, calibration = pd.read_csv(results / "scores.csv"), pd.read_csv(results / "calibration.csv")
    assert {"scenario", "hull", "model", "crps_s", "coverage_90", "pit_distance"} <= set(scores)
    assert {"P_Stat with residual spread", "P_Prob (literal)", "P_Prob (calibrated)", "P_Prob (extended)", "regression"} <= set(
        scores["model"]
    )
    assert {"coverage", "pit", "crps_by_exponent", "required_coverage"} <= set(calibration["quantity"])
    for name in ("scores", "calibration", "pit"):
        for suffix in ("svg", "png"):
            assert (results / f"figures/{name}.{suffix}").stat().st_size > 5_000
    assert "<h1>" in (results / "report.html").read_text()
    run = json.loads((results / "run.json").read_text())
    jobs = {path.relative_to(results).parts[1] for path in results.glob("0/**/log.txt")}
    assert {"score_maps", "simulate_trials", "count_distances", "build_report"} <= jobs
    assert {stage["stage"] for stage in run["stages"]} == {*jobs, "record_run"}
    # A Python with numpy in it holds more than 20 MB.
    assert all(stage["wall_s"] > 0 and 20 < stage["peak_memory_mb"] < 4000 for stage in run["stages"])
    assert run["config"]["seed"] == run["seed"]


@pytest.mark.parametrize(("cores", "shards"), [(1, 4), pytest.param(2, 3, marks=pytest.mark.slow)])
def test_neither_cores_nor_shards_change_the_data(finished, project, cores, shards):
    # Held against two cores and one shard.
    project.run("--cores", f"{cores}", *TINY, "--config", f"shards={shards}", "--until", "publish_scores")
    assert len(list((project.folder / "results/tiny/0/score_maps").rglob("maps.nc"))) == shards
    sharded = ("record_training", "extract_training", "plan_training", "score_maps")
    ours, theirs = project.checksums(skip=sharded), finished.checksums(skip=sharded)
    assert {"0/check_claims/claims.csv", "0/ablate_parameters/ablations.csv", "0/leave_out/summary.csv"} <= set(ours)
    assert {"claims.csv", "scores.csv", "calibration.csv"} <= set(ours)
    assert ours == {name: theirs[name] for name in ours}
    for stage, file in (("extract_training", "samples.parquet"), ("plan_training", "vectors.parquet")):
        first, second = (
            pd.concat(map(pd.read_parquet, (one.folder / f"results/tiny/0/{stage}").rglob(file))).sort_values(
                ["walk"], kind="stable"
            )
            for one in (finished, project)
        )
        pd.testing.assert_frame_equal(first.reset_index(drop=True), second.reset_index(drop=True), check_exact=True)


# What is learned, and all that it may be learned from.
LEARNED = ("build_space", "fit_static", "calibrate_model", "train_model")
OF_TRAINING = {"draw_participants", "record_training", "extract_training", "plan_training", "score_maps", *LEARNED}


def history(project) -> dict[str, tuple[str, list[str]]]:
    """Product -> its rule and the files that were read for it, as Snakemake has recorded them."""
    lines = [line.split("\t") for line in project.run("--detailed-summary", *TINY).splitlines()]
    head = next(line for line in lines if line[0] == "output_file")
    rows = [dict(zip(head, line, strict=True)) for line in lines if len(line) == len(head) and line is not head]
    return {row["output_file"]: (row["rule"], row["input-file(s)"].split(",")) for row in rows}


def behind(made: dict[str, tuple[str, list[str]]], rules: tuple[str, ...]) -> set[str]:
    """Every file that the products of some rules go back to."""
    waiting, found = [file for rule, files in made.values() if rule in rules for file in files], set()
    while waiting:
        file = waiting.pop()
        if file not in found:
            found.add(file)
            waiting += made[file][1] if file in made else []
    return found


def test_nothing_that_is_learned_goes_back_to_experiment_2(finished):
    made = history(finished)
    assert {rule for rule, _ in made.values()} >= set(LEARNED)
    learned_from = behind(made, LEARNED)
    assert {made[file][0] for file in learned_from if file in made} <= OF_TRAINING
    assert not [file for file in learned_from if "scenario" in file]
    assert [file for file in behind(made, ("score_forecasts",)) if "extract_scenario" in file], "else nothing would be found"


def test_what_is_learned_is_the_same_with_junk_in_place_of_experiment_2(finished_copy):
    base = finished_copy.folder / "results/tiny/0"
    learned = {f"0/{rule}" for rule in LEARNED}
    of_learned = lambda: {  # noqa: E731
        name: digest for name, digest in finished_copy.checksums().items() if name.rpartition("/")[0] in learned
    }
    before, logs = of_learned(), {rule: (base / rule / "log.txt").stat().st_mtime_ns for rule in LEARNED}
    assert {"0/calibrate_model/calibration.json", "0/train_model/model.safetensors"} <= set(before)
    junk = [path for stage in ("record", "extract", "plan") for path in (base / f"{stage}_scenario").rglob("*.parquet")]
    assert len(junk) >= 6
    for path in junk:
        path.write_bytes(b"junk")
    targets = [f"results/tiny/{name}" for name in before if "calibration.json" in name or "model.safetensors" in name]
    finished_copy.run(*targets, "--cores", "2", *TINY, "--forcerun", *LEARNED)
    assert all((base / rule / "log.txt").stat().st_mtime_ns > logs[rule] for rule in LEARNED), "each was run again"
    assert of_learned() == before


def test_nothing_is_left_to_do_after_a_run(finished_copy):
    assert "Nothing to be done" in finished_copy.run("--dry-run", "--cores", "2", *TINY)


def test_an_edited_comment_reruns_nothing_but_the_list_of_assumptions(finished_copy):
    path = finished_copy.folder / "src/walklab/evaluation/production.py"
    path.write_text(path.read_text() + "\n# a remark\n")
    assert jobs(finished_copy.run("--dry-run", "--cores", "2", *TINY)) <= LISTING


def test_an_edited_module_reruns_exactly_its_dependents(finished_copy):
    edit(finished_copy.folder / "src/walklab/evaluation/production.py", "\nfrom ", "\nEDITED = True\nfrom ")
    rerun = jobs(finished_copy.run("--dry-run", "--cores", "2", *TINY))
    assert rerun == {"estimate_saving", "check_claims", "draw_claims", "publish_scores", "describe_model", *LISTING}


def test_a_changed_parameter_reruns_its_stage_and_what_follows(finished_copy):
    (finished_copy.folder / "five.yaml").write_text("leave_out: {cells: 5}")
    planned = jobs(finished_copy.run("--dry-run", "--cores", "2", *TINY, "five.yaml"))
    assert "leave_out" in planned
    assert not planned & {"score_maps", "build_space", "simulate_trials", "record_training"}


@pytest.mark.slow  # the tests of faults kill a shorter part of the study at random moments
def test_a_run_killed_with_sigkill_resumes_to_identical_results(finished, project):
    arguments = ("--cores", "2", *TINY, "--until", "simulate_trials")
    process = project.start(*arguments)
    base = project.folder / "results/tiny/0"
    deadline = time.monotonic() + 240
    while time.monotonic() < deadline and not list(base.glob("score_maps/*/maps.nc")):
        assert process.poll() is None, process.communicate()[0][-4000:]
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    assert not list(base.glob("simulate_trials/*/trials.parquet")), "killed too late to test anything"
    project.run("--unlock", *TINY)
    project.run(*arguments, "--rerun-incomplete")
    ours, theirs = project.checksums(), finished.checksums()
    assert any(name.startswith("0/simulate_trials") for name in ours)
    assert ours == {name: theirs[name] for name in ours}
    assert not [path for path in base.rglob(".*") if path.is_file()], "half-written files"


PLANNERS = {
    "two parameters, another planner": {
        "planner": {"name": "social_force"},
        "space": [
            {"name": "v", "unit": "m/s", "values": [0.5, 1.0, 1.5]},
            {"name": "tau", "unit": "s", "values": [0.3, 0.6, 1.2]},
        ],
    },
    "four parameters": {
        "space": [
            {"name": "v", "unit": "m/s", "values": [0.5, 1.0, 1.5]},
            {"name": "a", "unit": "m/s²", "values": [0.5, 1.0, 1.5]},
            {"name": "omega", "unit": "1/m", "values": [0.8, 1.6]},
            {"name": "b", "unit": "m/s²", "values": [0.5, 1.5]},
        ],
    },
}


# What draws or judges parameters: with one planner to the verdicts and scores, with the other to the maps and the trials.
REACHED = {
    "two parameters, another planner": ["draw_claims", "draw_forecasts", "draw_fig08", "draw_fig09", "draw_fig10", "draw_fig13"],
    "four parameters": ["simulate_trials", "draw_fig05", "draw_fig06", "draw_fig08", "draw_fig09"],
}


@pytest.mark.parametrize("name", PLANNERS)
def test_another_planner_needs_only_configuration(project, name):
    (project.folder / "planner.yaml").write_text(json.dumps(PLANNERS[name]))
    project.run("--cores", "2", "--configfile", "tests/workflow/tiny.yaml", "planner.yaml", "--until", *REACHED[name])
    for rule in REACHED[name]:
        if "fig" in rule:
            figure = rule.removeprefix("draw_")
            assert (project.folder / f"results/tiny/figures/{figure}.svg").stat().st_size > 5_000
    trials = pd.read_parquet(project.folder / "results/tiny/0/simulate_trials/scenario_1/trials.parquet")
    names = [axis["name"] for axis in PLANNERS[name]["space"]]
    assert set(names) <= set(trials.columns)
    drawn = trials[trials["model"] == "P_Prob"]
    for axis in PLANNERS[name]["space"]:
        assert drawn[axis["name"]].between(axis["values"][0], axis["values"][-1]).all()
    assert drawn[names].drop_duplicates().shape[0] > 5


def test_own_walks_go_through_the_same_chain(project):
    project.run("--cores", "2", "--configfile", "config/own.yaml", "tests/workflow/tiny.yaml", "--config", "run=own")
    scores = pd.read_csv(project.folder / "results/own/scores.csv")
    assert {"P_Stat (point)", "P_Adapt (point)", "P_Prob (literal)"} <= set(scores["model"])
    assert scores.groupby("model")["participant"].nunique().min() >= 2


ACCLAIM = {
    "run": "acclaim",
    "source": {"path": "recordings"},
    "blending_space": {"entries": None},
    "model": {"k": 3},
    "shards": 1,
    "planner": {"options": {"cell_m": 0.05}, "time_limit_s": 15},
    "space": [
        {"name": "v", "unit": "m/s", "values": [0.7, 1.3]},
        {"name": "a", "unit": "m/s²", "values": [0.5, 1.5]},
        {"name": "omega", "unit": "1/m", "values": [0.8, 1.6]},
    ],
}


def test_acclaim_recordings_go_through_the_same_chain(project):
    data = Path(os.environ["WALKLAB_DATA"]).resolve() / "cmu_walk_amc/data"
    if not data.is_dir():
        pytest.skip(f"no recordings: {data} does not exist; set WALKLAB_DATA")
    subjects = [folder for folder in sorted(data.iterdir()) if len(list(folder.glob("*.amc"))) >= 3][:3]
    for folder in subjects:
        copied = project.folder / "recordings" / folder.name
        copied.mkdir(parents=True)
        for file in [*folder.glob("*.asf"), *sorted(folder.glob("*.amc"))[:3]]:
            shutil.copy(file, copied)
    (project.folder / "acclaim.yaml").write_text(json.dumps(ACCLAIM))
    configurations = ("config/cmu.yaml", "tests/workflow/tiny.yaml", "acclaim.yaml")
    project.run("--cores", "2", "--configfile", *configurations, "--until", "publish_scores")
    scores = pd.read_csv(project.folder / "results/acclaim/scores.csv")
    people = scores.groupby("model")["participant"].nunique()
    assert {"P_Stat (point)", "P_Adapt (point)", "P_Prob (literal)", "climatology", "regression"} <= set(people.index)
    assert (people == len(subjects)).all(), "a row per subject and model"
    assert not scores.duplicated(["participant", "model"]).any()
    assert scores["crps_s"].gt(0).all()


def test_the_examples_of_the_page_on_the_model_run_on_a_study(finished, monkeypatch):
    text = (ROOT / "docs/model.md").read_text().replace("results/steering", "results/tiny")
    names: dict[str, object] = {}
    monkeypatch.chdir(finished.folder)
    blocks = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", OutsideTrainingRange)  # four people's walks are no study
        for block in blocks:
            exec(block, names)
        drawn = [eval(line.split("  #")[0], names) for block in blocks for line in block.splitlines() if ", 3)" in line]
    assert [draws.shape for draws in drawn] == [(100, 3)] * 3, "the literal, the calibrated and the extended model"
