"""Figure 13: what each parameter contributes."""

from adapter import job
from paper_inputs import published
from walklab.figures.evaluation import fig13
from walklab.figures.style import save
from walklab.storage import read_table

if __name__ == "__main__":
    with job(snakemake):
        _, claims = published(snakemake.input.paper)
        tables = read_table(snakemake.input.ablations), read_table(snakemake.input.calibrated)
        save(fig13(tables[0], claims["ablation_median_abs_dt_s"], tables[1]), *snakemake.output)
