"""Run the study of one specification and judge every claim by it; what goes wrong is an outcome too."""

from adapter import job
from capture_inputs import constants_of
from multiverse_inputs import capture_design, specification_of, study_settings
from walklab.capture.ranges import constants_at
from walklab.capture.walks import read_walk_table
from walklab.evaluation.claims import load_paper
from walklab.multiverse.outcome import attempt, evaluate
from walklab.multiverse.population import TRAINING, population_of, record_population
from walklab.multiverse.specifications import CHOICE, DEFAULT
from walklab.storage import read_table, write_json, write_table


def tables_of(snakemake, positions, design):
    """Walks and samples of every group, recorded with other constants or as they were recorded for all."""
    if positions:
        return record_population(design, constants_at(positions, constants_of(snakemake.params.generator)))
    names, files = [TRAINING, *snakemake.params.scenarios], snakemake.input
    return {
        name: (read_walk_table(walks, accepted_only=False), read_table(samples))
        for name, walks, samples in zip(names, files.walks, files.samples, strict=True)
    }


def study(snakemake, specification):
    """Claims and outcome of one specification."""
    params, design = snakemake.params, capture_design(snakemake)
    population = population_of(tables_of(snakemake, specification.positions, design))
    settings, paper = study_settings(params, design), load_paper(snakemake.input.paper)
    # The sub-models of 8.1 cost more than all the rest; they are asked of the paper's ambiguities one at a time.
    return evaluate(specification, population, settings, paper, ablate=specification.kind in (DEFAULT, CHOICE))


if __name__ == "__main__":
    with job(snakemake):
        specification = specification_of(snakemake)
        claims, outcome = attempt(specification, lambda: study(snakemake, specification))
        write_table(claims, snakemake.output.claims)
        write_json(outcome, snakemake.output.outcome)
