"""Show the scores of the one population at the top of the run."""

from pathlib import Path

from adapter import job
from walklab.storage import write_text

if __name__ == "__main__":
    with job(snakemake):
        for source, target in zip(snakemake.input, snakemake.output, strict=True):
            write_text(Path(source).read_text(), target)
