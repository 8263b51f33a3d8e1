"""Record what was run, with which versions, how long it took and how much memory."""

from adapter import job
from walklab.run_record import record
from walklab.storage import write_json

if __name__ == "__main__":
    with job(snakemake):
        write_json(record(snakemake.params.config, snakemake.params.root, snakemake.params.benchmarks), snakemake.output.record)
