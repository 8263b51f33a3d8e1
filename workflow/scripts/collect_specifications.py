"""Put the claims and outcomes of all specifications together."""

from adapter import job
from walklab.multiverse.outcome import collect
from walklab.multiverse.verdicts import summary
from walklab.storage import read_json, read_table, write_table

if __name__ == "__main__":
    with job(snakemake):
        files = snakemake.input
        claims, specifications = collect(
            read_table(files.specifications), [read_table(path) for path in files.claims], list(map(read_json, files.outcomes))
        )
        write_table(claims, snakemake.output.claims)
        write_table(specifications, snakemake.output.specifications)
        write_table(summary(claims), snakemake.output.summary)
