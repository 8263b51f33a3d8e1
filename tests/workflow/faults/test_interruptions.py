"""Runs that are killed, stopped, doubled, or overtaken by the clock go on to the results of an undisturbed run."""

import os
import shutil
import signal
import time

import numpy as np
import psutil
import pytest
from typer.testing import CliRunner

from walklab.cli.app import app

pytestmark = pytest.mark.workflow


# Kills, what is run, and how many jobs may end before the next kill: twenty kills are to reach the report, too.
KILLS = [(3, "study", 3), pytest.param(20, "whole_study", 8, marks=pytest.mark.slow)]


@pytest.mark.parametrize(("kills", "part", "jobs"), KILLS)
def test_a_run_killed_at_random_moments_resumes(kills, part, jobs, tally, request):
    """One run is killed again and again until it is done; then the next one, until all kills are spent.

    A kill is survived if the run it hit ends like an undisturbed one.
    """
    study = request.getfixturevalue(part)
    fault = "SIGKILL of the run"
    rng = np.random.default_rng(kills)
    spent = 0
    while spent < kills:
        in_this_run = 0
        while spent < kills:
            process = study.start()
            study.wait_for_jobs(process, study.finished_jobs() + int(rng.integers(0, jobs)))
            time.sleep(rng.uniform(0, 2))
            if process.poll() is not None:
                break
            tally.tried(fault)
            _kill(process)
            spent, in_this_run = spent + 1, in_this_run + 1
            study.assert_whole()
            study.unlock()
        study.run()
        study.assert_undisturbed()
        if in_this_run:
            tally.survived(fault, in_this_run)
        shutil.rmtree(study.results)


def _kill(process):
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()


def test_a_killed_job_is_named_and_done_again(done, tally):
    done.remove("score_maps", "build_space", "train_model")
    with tally.attempt("SIGKILL of a job"):
        process = done.start()
        _wait_for(process, "score_maps.py").kill()
        output, _ = process.communicate()
        assert process.returncode != 0
        assert "score_maps" in output
        done.assert_whole()
        done.run()
        done.assert_undisturbed()


@pytest.mark.slow
def test_jobs_go_on_when_only_snakemake_is_killed_and_the_run_is_taken_up_after_them(done, tally):
    done.remove("score_maps", "build_space", "train_model")
    with tally.attempt("SIGKILL of Snakemake alone"):
        process = done.start()
        job = _wait_for(process, "score_maps.py")
        jobs = psutil.Process(process.pid).children(recursive=True)
        process.kill()
        process.wait()
        assert job.is_running()
        assert "cannot be locked" in done.run(fails=True)
        _, going_on = psutil.wait_procs(jobs, timeout=600)
        process.communicate()
        assert not going_on
        assert list((done.results / "0/score_maps").rglob("maps.nc")), "what went on left nothing"
        done.assert_whole()
        done.unlock()
        done.run()
        done.assert_undisturbed()


def _wait_for(process, script):
    """The first job of a run that runs a script."""
    while process.poll() is None:
        for child in psutil.Process(process.pid).children(recursive=True):
            if _runs(child, script):
                return child
        time.sleep(0.02)
    raise AssertionError(process.communicate()[0][-4000:])


def _runs(process, script):
    try:
        command = process.cmdline()
    except psutil.Error:
        return False
    # The shell in between has the script in one long argument.
    return bool(command) and "python" in command[0] and command[-1].endswith(script)


def test_ctrl_c_leaves_a_run_that_just_goes_on(done, tally):
    done.remove("record_training", "extract_training", "plan_training", "score_maps", "build_space", "train_model")
    # Started in the background, pytest ignores this signal, and so would what it starts.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with tally.attempt("Ctrl-C"):
        before = done.finished_jobs()
        process = done.start()
        assert done.wait_for_jobs(process, before + 2), process.communicate()[0][-4000:]
        os.killpg(process.pid, signal.SIGINT)
        process.communicate(timeout=300)
        assert process.returncode != 0
        done.assert_whole()
        done.run()  # no --unlock
        done.assert_undisturbed()


def test_a_second_run_in_the_same_folder_is_refused(done, tally):
    done.remove("score_maps", "build_space", "train_model")
    with tally.attempt("two runs at once"):
        before = done.finished_jobs()
        process = done.start()
        assert done.wait_for_jobs(process, before + 1), process.communicate()[0][-4000:]
        assert "cannot be locked" in done.run(fails=True)
        output, _ = process.communicate(timeout=600)
        assert process.returncode == 0, output[-4000:]
        done.assert_undisturbed()


def test_a_clock_that_goes_back_is_noticed_and_put_right(done, tally):
    done.remove("build_space", "train_model")
    with tally.attempt("clock going back"):
        tomorrow = time.time() + 86_400
        for path in done.results.rglob("*"):
            if path.is_file():
                os.utime(path, (tomorrow, tomorrow))
        assert "clock skew" in done.run(fails=True)
        told = CliRunner().invoke(app, ["check", str(done.results)]).output
        assert "was dated in the future" in told
        done.run()
        done.assert_undisturbed()
        assert "Job stats" not in done.run("--dry-run"), "something is left to do"
