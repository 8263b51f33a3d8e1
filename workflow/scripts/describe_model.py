"""Publish the run's model under the name that other programs load, with its card."""

from adapter import job
from walklab.runs.card import model_card, publish_model
from walklab.storage import read_table, write_text

if __name__ == "__main__":
    with job(snakemake):
        publish_model(snakemake.input.model, snakemake.output.model)
        card = model_card(snakemake.input.model, snakemake.params.source["kind"], read_table(snakemake.input.scores))
        write_text(
            card.replace("# Model card: model.safetensors", f"# Model card: {snakemake.params.run}", 1), snakemake.output.card
        )
