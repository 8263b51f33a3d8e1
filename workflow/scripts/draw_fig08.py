"""Figure 8: blended maps for growing distances."""

import numpy as np

from adapter import job
from walklab.figures.maps import fig08
from walklab.figures.style import save
from walklab.steering.io import read_model

if __name__ == "__main__":
    with job(snakemake):
        model = read_model(snakemake.input.model)
        shown = snakemake.params.draw_fig08
        lengths_m = np.linspace(*shown["length_m"], shown["maps"])
        values = {"length": lengths_m, "curvature": shown["curvature_1_m"], "height": shown["height_m"], "start_speed": 0.0}
        vectors = np.column_stack([np.broadcast_to(values[name], len(lengths_m)) for name in model.dependencies])
        save(fig08(model.blend(vectors), lengths_m, model.space, shown["curvature_1_m"], shown["height_m"]), *snakemake.output)
