"""Print what studies of 10^3, 10^5 and 10^7 walks cost, from the measured jobs of finished runs (Markdown).

Usage: sizing.py RUN RUN ..., of different sizes, as results/steering results/large
"""

import argparse

from walklab.errors import InputError
from walklab.runs.sizing import as_markdown, measured, sizing

if __name__ == "__main__":
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("runs", nargs="+", help="folders of finished runs")
    arguments.add_argument("--walks", type=int, nargs="+", default=[10**3, 10**5, 10**7])
    arguments.add_argument("--walks-per-shard", type=int, default=2000)
    arguments.add_argument("--node-memory-gb", type=float, default=256.0)
    asked = arguments.parse_args()
    try:
        print(as_markdown(sizing(measured(asked.runs), asked.walks, asked.walks_per_shard), asked.node_memory_gb))
    except InputError as error:
        arguments.error(str(error))
