"""Draw the participants of the three groups."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from adapter import job
from walklab.capture.constants import WalkerConstants
from walklab.capture.io import write_participants
from walklab.capture.participants import Distribution, Group, draw_participants
from walklab.randomness import generator


def draw(groups: Mapping[str, Mapping[str, Any]], seed: int, replicate: int) -> pd.DataFrame:
    """All participants, one row each."""
    return pd.concat(
        [
            draw_participants(as_group(name, group), WalkerConstants(), generator(seed, replicate, "participants", name))
            for name, group in groups.items()
        ],
        ignore_index=True,
    )


def as_group(name: str, group: Mapping[str, Any]) -> Group:
    return Group(
        name, group["count"], group["female"], *(Distribution(**group[key]) for key in ("age_years", "height_m", "mass_kg"))
    )


if __name__ == "__main__":
    with job(snakemake):
        participants = draw(snakemake.params.participants, snakemake.params.seed, int(snakemake.wildcards.replicate))
        write_participants(participants, snakemake.output.participants)
