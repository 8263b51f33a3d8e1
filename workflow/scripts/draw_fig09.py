"""Figure 9: the run-time procedure on one walk."""

from adapter import job
from trial_inputs import trial_inputs
from walklab.evaluation.illustrations import most_bent, work_through
from walklab.figures.blending import fig09
from walklab.figures.style import save
from walklab.randomness import generator
from walklab.steering.io import read_model

if __name__ == "__main__":
    with job(snakemake):
        inputs = trial_inputs(snakemake)
        model = read_model(snakemake.input.model)
        query = inputs.vectors[most_bent(inputs.walks, inputs.routes)]
        steps = work_through(model, query, generator(inputs.seed, inputs.replicate, "draw_fig09"))
        figure = fig09(
            model.blending.vectors,
            model.dependencies,
            model.dependency_units,
            steps.query,
            steps.neighbours,
            steps.weights,
            steps.blended,
            model.space,
            steps.fine_values,
            steps.fine,
            steps.accepted,
            steps.rejected,
            steps.held_at,
        )
        save(figure, *snakemake.output)
