"""Figure 14: error and time over the number of neighbours."""

from adapter import job
from paper_inputs import published
from walklab.figures.evaluation import fig14
from walklab.figures.style import save
from walklab.storage import read_table

if __name__ == "__main__":
    with job(snakemake):
        sweep = published(snakemake.input.paper)[1]["k_sweep"]
        errors, timings, calibrated = (read_table(snakemake.input[name]) for name in ("errors", "timings", "calibrated"))
        save(fig14(errors, timings, sweep["median_abs_dt_s"], sweep["interpolation_ms"], calibrated), *snakemake.output)
