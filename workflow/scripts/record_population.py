"""Record and cut the walks of the population that all specifications with the generator's own constants share."""

from adapter import job
from capture_inputs import constants_of
from multiverse_inputs import capture_design
from walklab.capture.walks import write_walks
from walklab.multiverse.population import record_population

if __name__ == "__main__":
    with job(snakemake):
        found = record_population(capture_design(snakemake), constants_of(snakemake.params.generator))
        for (walks, samples), *paths in zip(found.values(), snakemake.output.walks, snakemake.output.samples, strict=True):
            write_walks(walks, samples, *paths)
