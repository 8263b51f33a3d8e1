"""The study on a real Slurm, a cluster of one node on this machine: same files, whatever happens to its jobs."""

import os
import shutil
import socket
import subprocess
from pathlib import Path

import psutil
import pytest

pytestmark = pytest.mark.workflow

SCRIPT = Path(__file__).parents[1] / "slurm_one_node.sh"
INSTALLED = Path("/etc/slurm/slurm.conf")
PROGRAMS = ("slurmctld", "slurmd", "sbatch", "srun", "squeue", "scancel", "scontrol", "munged")
# The node promises twice the machine's two cores: the jobs are short and mostly start up.
CPUS = 4
ON_CLUSTER = (
    *("--workflow-profile", "profiles/slurm", "--slurm-no-account", "--slurm-status-command", "squeue"),
    *("--jobs", "8", "--cores", "2", "--latency-wait", "10"),
    *("--slurm-init-seconds-before-status-checks", "1", "--seconds-between-status-checks", "1"),
)


def reason_against_a_cluster():
    """Why no cluster can be started here; empty if it can."""
    missing = [name for name in PROGRAMS if shutil.which(name) is None]
    if os.geteuid() != 0:
        return "a cluster of one node can only be started by root"
    if missing:
        return f"no {', '.join(missing)}: apt-get install slurmctld slurmd slurm-client munge"
    # What a killed test has left is taken away.
    cleared = subprocess.run([SCRIPT, "clear"], capture_output=True, text=True, check=False, timeout=120)
    return cleared.stderr.strip() if cleared.returncode else ""


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """A cluster of one node, empty queue, stopped at the end."""
    if reason := reason_against_a_cluster():
        print(f"skipped: {reason}")
        pytest.skip(reason)
    folder = tmp_path_factory.mktemp("cluster")
    subprocess.run([SCRIPT, "start", folder, str(CPUS)], check=True, timeout=120)
    yield folder
    subprocess.run([SCRIPT, "stop", folder], check=True, timeout=120)


def slurm(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=60).stdout


def running():
    """Numbers of the jobs that compute."""
    return slurm("squeue", "--noheader", "--states=RUNNING", "--format=%A").split()


def submitted(output):
    return sum(" submitted with SLURM jobid" in line for line in output.splitlines())


def finish(process):
    """What a run printed; a queue takes its time."""
    output, _ = process.communicate(timeout=3000)
    assert process.returncode == 0, output[-6000:]
    return output


@pytest.mark.parametrize("folder_is_gone", [False, True])
def test_a_cluster_whose_starter_was_killed_is_taken_away(folder_is_gone, tmp_path):
    """Stands before the tests that share a cluster."""
    if reason := reason_against_a_cluster():
        pytest.skip(reason)
    subprocess.run(["bash", "-c", f"'{SCRIPT}' start '{tmp_path}'; exit $?"], check=True, timeout=120)
    assert INSTALLED.is_symlink()
    # No command line: a process that ends just now.
    known = psutil.process_iter(["cmdline"])
    daemons = [found for found in known if any(str(tmp_path) in part for part in found.info["cmdline"] or ())]
    assert {found.name() for found in daemons} == {"slurmctld", "slurmd", "munged"}
    if folder_is_gone:
        shutil.rmtree(tmp_path)
    assert reason_against_a_cluster() == ""
    assert not INSTALLED.is_symlink()
    assert not psutil.wait_procs(daemons, timeout=20)[1]


def test_the_cluster_of_a_test_that_runs_is_left_alone(cluster):
    assert "is running" in reason_against_a_cluster()
    assert INSTALLED.is_symlink()


def test_the_tiny_study_on_a_cluster_gives_the_local_files(cluster, study, tally):
    with tally.attempt("Slurm instead of this machine"):
        output = finish(study.project.start(*ON_CLUSTER, *study.arguments[2:]))
        assert submitted(output) >= 4, output[-4000:]  # small jobs that follow each other are one
        study.assert_undisturbed()


@pytest.mark.slow
def test_shards_that_are_ready_together_are_one_array(cluster, done):
    learned = {name: digest for name, digest in done.undisturbed.items() if name.startswith(("0/build_space", "0/train_model"))}
    output = finish(done.project.start(*ON_CLUSTER, *done.arguments[2:], "--config", "shards=3"))
    assert "individual task IDs" in output, output[-4000:]
    assert len(list(done.results.rglob("maps.nc"))) == 3
    assert learned
    assert {name: done.products()[name] for name in learned} == learned


@pytest.mark.slow
def test_the_small_study_with_two_replicates_on_a_cluster_gives_the_local_files(cluster, project):
    small = ("--configfile", "config/small.yaml", "--config", "replicates=2")
    finish(project.start(*ON_CLUSTER, *small))
    on_cluster = project.checksums("small")
    shutil.rmtree(project.folder / "results")
    shutil.rmtree(project.folder / ".snakemake")
    finish(project.start("--cores", "2", *small))
    assert {"1", "2", "claims.csv", "scores.csv"} <= {name.split("/")[0] for name in on_cluster}
    assert on_cluster == project.checksums("small")


@pytest.mark.slow
def test_a_cancelled_job_is_submitted_again(cluster, study, wait_until, tally):
    with tally.attempt("scancel"):
        process = study.project.start(*ON_CLUSTER, *study.arguments[2:])
        assert wait_until(lambda: study.finished_jobs() >= 1 and running())
        slurm("scancel", *running())
        finish(process)
        study.assert_undisturbed()


@pytest.mark.slow
def test_a_drained_node_finishes_its_jobs_and_the_rest_waits_for_it(cluster, study, wait_until, tally):
    node = f"nodename={socket.gethostname().split('.')[0]}"
    with tally.attempt("node drained and resumed"):
        process = study.project.start(*ON_CLUSTER, *study.arguments[2:])
        assert wait_until(lambda: bool(running()))
        slurm("scontrol", "update", node, "state=drain", "reason=test")
        try:
            # What ran ends, what follows is submitted and waits.
            assert wait_until(lambda: not running() and slurm("squeue", "--noheader", "--states=PENDING"))
            assert process.poll() is None
        finally:
            slurm("scontrol", "update", node, "state=resume")
        finish(process)
        study.assert_undisturbed()
