"""Record what was run, with which code and versions, what came out, how long it took and how much memory."""

from adapter import job
from walklab.runs.record import record
from walklab.storage import write_json

if __name__ == "__main__":
    with job(snakemake):
        given = snakemake.params
        products = list(snakemake.input.products)
        found = record(given.config, given.root, given.costs, given.digests, products, given.folder, "record_run")
        write_json(found, snakemake.output.record)
