"""Figure 4: set-ups and captured trajectories of experiment 1."""

import pandas as pd

from adapter import job
from walk_inputs import all_walks
from walklab.figures.capture import fig04
from walklab.figures.style import save
from walklab.geometry.plans import load_plan

if __name__ == "__main__":
    with job(snakemake):
        walks = all_walks(snakemake.input.walks, snakemake.input.samples)
        samples = [
            pd.DataFrame({"walk": walk.row["walk"], "x_m": walk.position_m[:, 0], "y_m": walk.position_m[:, 1]}) for walk in walks
        ]
        plans = {plan.scene.name: plan for plan in map(load_plan, snakemake.input.plans)}
        table = pd.DataFrame([walk.row for walk in walks]).reset_index(drop=True)
        save(fig04(table, pd.concat(samples, ignore_index=True), plans), *snakemake.output)
