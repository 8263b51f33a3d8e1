"""Figure 3: planned walk distances."""

from adapter import job
from paper_inputs import published
from walklab.figures.capture import fig03
from walklab.figures.style import save
from walklab.storage import read_table

if __name__ == "__main__":
    with job(snakemake):
        inputs, _ = published(snakemake.input.paper)
        save(fig03(read_table(snakemake.input.classes), inputs["planned_walk_paths"]["count"]), *snakemake.output)
