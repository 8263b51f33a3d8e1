"""Hold every claim of the paper against the tables of this run."""

from adapter import job
from walklab.evaluation.claims import check_claims, load_paper
from walklab.evaluation.statistics import by_dataset
from walklab.storage import read_table, write_table


def tables_of(files, scenarios):
    """The tables under the names that the verdicts use."""
    tables = {
        name: by_dataset(dict(zip(scenarios, map(read_table, files[name]), strict=True)))
        for name in ("description", "percentiles", "reductions", "comparisons")
    }
    # A run without the ablations says so beside each claim that needs them.
    single = ("optimum", "ablations", "leave_one_out", "neighbours", "neighbour_timings", "long_distance", "production")
    return tables | {name: read_table(files[name]) for name in single if hasattr(files, name)}


if __name__ == "__main__":
    with job(snakemake):
        tables = tables_of(snakemake.input, list(snakemake.params.scenarios))
        write_table(check_claims(load_paper(snakemake.input.paper), tables), snakemake.output.claims)
