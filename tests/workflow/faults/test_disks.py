"""Full and read-only disks end in one line; damaged files are found, named and made again."""

import os
import subprocess
from contextlib import contextmanager

import pytest
from typer.testing import CliRunner

from walklab.cli.app import app

pytestmark = pytest.mark.workflow

ROOT_USER = os.geteuid() == 0


@contextmanager
def mounted(folder, *arguments):
    """A mount on a folder, for as long as the block lasts."""
    folder.mkdir(parents=True, exist_ok=True)
    made = subprocess.run(["mount", *arguments, str(folder)], capture_output=True, text=True, check=False) if ROOT_USER else None
    if made is None or made.returncode:
        pytest.skip(f"needs the right to mount ({made.stderr.strip() if made else 'not root'})")
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=True)


def remount(folder, options):
    """Mount again with other options; not possible while a file is being written."""
    subprocess.run(["mount", "-o", f"remount,{options}", str(folder)], check=True)


def test_a_full_disk_is_named_and_more_space_is_enough(study, finished, tally):
    folder = study.project.folder / "results"
    needed = sum((finished.folder / "results/tiny" / name).stat().st_size for name in study.undisturbed)
    # The recordings fit, what is made of them does not.
    with mounted(folder, "-t", "tmpfs", "-o", f"size={int(0.6 * needed)}", "tmpfs"), tally.attempt("disk full"):
        output = study.run(fails=True)
        told = [line for line in output.splitlines() if "error in " in line and "No space left" in line]
        assert told, output[-6000:]
        assert "free some space" in told[0]
        assert "Traceback" not in output
        study.assert_whole()
        remount(folder, "size=500m")
        study.run()
        study.assert_undisturbed()


def test_results_that_are_read_only_stop_the_run_before_its_first_job(done, tally):
    done.remove("train_model")
    folder = done.project.folder / "results"
    with mounted(folder, "--bind", str(folder)), tally.attempt("read-only results"):
        remount(folder, "ro,bind")
        output = done.run(fails=True)
        assert "is read-only; make it writable" in output
        assert "Traceback" not in output
        remount(folder, "rw,bind")
        done.run()
        done.assert_undisturbed()


def test_a_read_only_folder_in_the_middle_of_a_run_is_named_and_nothing_is_lost(done, tally):
    done.remove("score_maps", "build_space", "train_model")
    folder = done.results / "0/build_space"
    with mounted(folder, "--bind", str(folder)), tally.attempt("read-only results"):
        remount(folder, "ro,bind")
        output = done.run(fails=True)
        assert "Read-only file system" in output
        assert "build_space" in output
        done.assert_whole()
        remount(folder, "rw,bind")
        done.run()
        done.assert_undisturbed()


def flip_a_bit(content: bytes) -> bytes:
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


DAMAGES = {
    "truncated file": ("score_maps/0/maps.nc", "build_space", lambda content: content[: len(content) // 2]),
    "bit-flipped file": ("build_space/blending_space.nc", "train_model", flip_a_bit),
    "empty file": ("plan_training/0/routes.parquet", "score_maps", lambda content: b""),
}


@pytest.mark.parametrize("fault", DAMAGES)
def test_a_damaged_file_is_named_and_made_again(done, tally, fault):
    name, reader, damage = DAMAGES[fault]
    with tally.attempt(fault):
        path = done.results / "0" / name
        times = path.stat()
        path.write_bytes(damage(path.read_bytes()))
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))  # damage does not change the date
        done.remove(reader)
        output = done.run(fails=True)
        # The first is the whole line; Snakemake shows the log, in which it stands again, wrapped.
        line = next(line for line in output.splitlines() if line.startswith(f"error in {reader}: "))
        assert f"results/tiny/0/{name}: damaged" in line
        assert "Traceback" not in output
        checked = CliRunner().invoke(app, ["check", str(done.results)])
        assert checked.exit_code == 1
        assert f"{name}: " in checked.output
        command = line.split("rebuild it: .venv/bin/snakemake ")[1].split(" (")[0]
        done.run(*command.split())
        done.assert_undisturbed()
