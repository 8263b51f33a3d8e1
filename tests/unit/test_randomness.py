"""Draws depend on the seed and on what they are for, and on nothing else."""

import subprocess
import sys

import numpy as np

from walklab.randomness import generator


def test_the_same_names_draw_the_same_numbers_in_any_order():
    forward = {name: generator(1, 0, "trial", name).random(3) for name in "abc"}
    backward = {name: generator(1, 0, "trial", name).random(3) for name in "cba"}
    assert all(np.array_equal(forward[name], backward[name]) for name in "abc")


def test_each_name_replicate_and_seed_has_its_own_numbers():
    draws = [generator(*key).random() for key in [(1, 0, "a"), (1, 0, "b"), (1, 1, "a"), (2, 0, "a"), (1, 0, "a", 0)]]
    assert len(set(draws)) == len(draws)


def test_another_process_draws_the_same_numbers():
    source = "from walklab.randomness import generator; print(generator(7, 0, 'trial', 'walk').random().hex())"
    other = subprocess.run([sys.executable, "-c", source], capture_output=True, text=True, check=True).stdout.strip()
    assert other == generator(7, 0, "trial", "walk").random().hex()
