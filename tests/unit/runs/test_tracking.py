"""A run in MLflow: parameters, metrics and files arrive, once, in a store on this machine."""

import pytest

from walklab.errors import InputError
from walklab.runs.io import read_record
from walklab.runs.tracking import EXPERIMENT, metrics, track


def test_every_number_has_a_name_that_mlflow_accepts(run):
    found = metrics(read_record(run))
    assert found["claim/first"] == pytest.approx(0.4)
    assert "claim/second" not in found, "a claim without a number"
    assert found["claims/not checkable"] == 1
    assert found["crps_s/scenario_1/P_Prob _calibrated/task"] == pytest.approx(0.2)
    assert found["wall_s/score_maps"] == pytest.approx(2.0)


def test_a_run_is_logged_once_to_sqlite(run):
    mlflow = pytest.importorskip("mlflow", reason="the extra walklab[tracking] is not installed")
    identity, new = track(run)
    assert new
    assert track(run) == (identity, False)
    assert (run.parent / "mlflow.db").is_file()
    client = mlflow.MlflowClient(f"sqlite:///{run.parent / 'mlflow.db'}")
    logged = client.get_run(identity)
    assert client.get_experiment(logged.info.experiment_id).name == EXPERIMENT
    assert logged.data.params["model.k"] == "100"
    assert logged.data.metrics["claim/first"] == pytest.approx(0.4)
    assert logged.data.tags["mlflow.source.git.commit"] == read_record(run)["commit"].get("id", "")
    assert {artifact.path for artifact in client.list_artifacts(identity)} == {"claims.csv", "run.json", "scores.csv"}


def test_an_unreachable_store_ends_in_one_line(run):
    pytest.importorskip("mlflow", reason="the extra walklab[tracking] is not installed")
    with pytest.raises(InputError, match="cannot be used as tracking store"):
        track(run, "nosuchscheme://nowhere")
