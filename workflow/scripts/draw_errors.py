"""Figures 11 and 12: travel-time errors in one scenario."""

from adapter import job
from paper_inputs import published
from walklab.figures.evaluation import travel_time_errors
from walklab.figures.style import save
from walklab.storage import read_table


def published_tests(wilcoxon, scenario, position):
    """The published tests of one scenario: powers are published as a pair, a bound of p for one scenario only."""
    return {
        pair: {
            key.removesuffix(f"_{scenario}"): value[position] if isinstance(value, list) else value
            for key, value in figures.items()
        }
        for pair, figures in wilcoxon.items()
    }


if __name__ == "__main__":
    with job(snakemake):
        _, claims = published(snakemake.input.paper)
        figure = travel_time_errors(
            read_table(snakemake.input.trials),
            read_table(snakemake.input.description),
            read_table(snakemake.input.comparisons),
            claims[f"{snakemake.params.scenario}_abs_dt_s"],
            published_tests(claims["wilcoxon"], snakemake.params.scenario, snakemake.params.position),
            snakemake.params.name,
        )
        save(figure, *snakemake.output)
