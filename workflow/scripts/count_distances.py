"""Sort the planned distances of the scenarios into classes (figure 3)."""

from adapter import job
from walklab.evaluation.distances import distance_shares
from walklab.storage import read_table, write_table

if __name__ == "__main__":
    with job(snakemake):
        names = list(snakemake.params.scenarios)
        tables = dict(zip(names, map(read_table, snakemake.input.vectors), strict=True))
        write_table(
            distance_shares({name: table["planned_length"].to_numpy() for name, table in tables.items()}),
            snakemake.output.classes,
        )
