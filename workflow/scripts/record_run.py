"""Record what was run, with which code and versions, what came out, how long it took and how much memory."""

from adapter import job
from walklab.runs.record import record
from walklab.storage import write_json

if __name__ == "__main__":
    with job(snakemake):
        given = snakemake.params
        found = record(given.config, given.root, given.benchmarks, given.digests, list(snakemake.input), given.folder)
        write_json(found, snakemake.output.record)
