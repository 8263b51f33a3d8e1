"""Draw the participants of the three groups."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from adapter import job
from capture_inputs import group_of
from walklab.capture.constants import WalkerConstants
from walklab.capture.io import write_participants
from walklab.capture.participants import draw_participants
from walklab.randomness import generator


def draw(groups: Mapping[str, Mapping[str, Any]], seed: int, replicate: int) -> pd.DataFrame:
    """All participants, one row each."""
    return pd.concat(
        [
            draw_participants(group_of(name, group), WalkerConstants(), generator(seed, replicate, "participants", name))
            for name, group in groups.items()
        ],
        ignore_index=True,
    )


if __name__ == "__main__":
    with job(snakemake):
        participants = draw(snakemake.params.participants, snakemake.params.seed, int(snakemake.wildcards.replicate))
        write_participants(participants, snakemake.output.participants)
