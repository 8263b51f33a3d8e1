"""Train the run-time model: interpolate every map of the blending space once and for all."""

from adapter import job
from walklab.steering.interpolation import interpolant_named
from walklab.steering.io import read_blending_space, write_model
from walklab.steering.models import probabilistic_model

if __name__ == "__main__":
    with job(snakemake):
        blending, space = read_blending_space(snakemake.input.space)
        choices = snakemake.params.model
        model = probabilistic_model(
            blending,
            space,
            interpolant_named(choices["basis"], space.shape, choices["kernel"], choices["epsilon"]),
            k=choices["k"],
            weights=choices["weights"],
            exponent=choices["exponent"],
            provenance={
                "run": snakemake.params.run,
                "seed": snakemake.params.seed,
                "replicate": int(snakemake.wildcards.replicate),
            },
        )
        write_model(model, snakemake.output.model)
