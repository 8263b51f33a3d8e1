"""How many walks were captured, how long they are, why some were rejected, and how exact their boundaries are."""

import pandas as pd

from adapter import job
from walklab.capture.summary import boundary_errors, capture_summary, rejection_counts
from walklab.capture.walks import read_walk_table
from walklab.storage import read_table, write_table

if __name__ == "__main__":
    with job(snakemake):
        walks = pd.concat([read_walk_table(path, accepted_only=False) for path in snakemake.input.walks], ignore_index=True)
        errors = pd.concat(map(read_table, snakemake.input.boundaries), ignore_index=True)
        write_table(capture_summary(walks).merge(boundary_errors(errors), on="dataset"), snakemake.output.summary)
        write_table(rejection_counts(walks), snakemake.output.rejections)
