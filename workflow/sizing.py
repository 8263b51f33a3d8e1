"""What studies of 10^3, 10^5 and 10^7 walks cost, from the measured jobs of finished runs: printed, or put into docs/cluster.md.

Usage: sizing.py RUN RUN ... [--write], runs of different sizes, as results/quarter results/large
The tables stand between the markers `<!-- sizing -->` and `<!-- /sizing -->`.
"""

import argparse
import re
from pathlib import Path

from walklab.errors import InputError
from walklab.runs.sizing import MEETING, as_markdown, measured, measurements, sizing
from walklab.storage import write_text

PAGE = Path(__file__).parents[1] / "docs/cluster.md"
MARKED = re.compile(r"<!-- sizing -->.*?<!-- /sizing -->", re.DOTALL)


def tables(asked):
    """Both tables and what they stand on, as Markdown."""
    stages = measured(asked.runs)
    largest = max(stages[MEETING], key=lambda job: job.walks)
    share = largest.added / largest.walks if asked.added_per_walk is None else asked.added_per_walk
    sized = sizing(stages, asked.walks, asked.walks_per_shard, share)
    names = ", ".join(f"`{Path(run).name}` ({job.walks:,} walks)" for run, job in zip(asked.runs, stages[MEETING], strict=True))
    return "\n".join(
        [
            f"A typical job of the runs {names}:",
            "",
            measurements(stages),
            "",
            f"Carried on, with {asked.walks_per_shard:,} walks a shard and {share:.2g} entries added a walk:",
            "",
            as_markdown(sized, asked.node_memory_gb, asked.job_hours),
        ]
    )


def put_in_page(text):
    """Replace what stands between the markers."""
    page, found = MARKED.subn(lambda _: f"<!-- sizing -->\n{text}\n<!-- /sizing -->", PAGE.read_text())
    if found != 1:
        raise InputError(f"{PAGE}: {found} places with the markers of sizing; there must be one")
    write_text(page, PAGE)


if __name__ == "__main__":
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("runs", nargs="+", help="folders of finished runs")
    arguments.add_argument("--walks", type=int, nargs="+", default=[10**3, 10**5, 10**7])
    arguments.add_argument("--walks-per-shard", type=int, default=2000)
    arguments.add_argument("--added-per-walk", type=float, help="blended entries; default: as in the largest run")
    arguments.add_argument("--node-memory-gb", type=float, default=256.0)
    arguments.add_argument("--job-hours", type=float, default=168.0, help="the longest job that a cluster takes")
    arguments.add_argument("--write", action="store_true", help="into docs/cluster.md")
    asked = arguments.parse_args()
    try:
        text = tables(asked)
        put_in_page(text) if asked.write else print(text)
    except InputError as error:
        arguments.error(str(error))
