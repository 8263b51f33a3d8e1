"""Where training walks and evaluated walks lie in the space of dependencies."""

from pathlib import Path

import pandas as pd

from adapter import job
from walklab.figures.blending import dependency_clouds
from walklab.figures.style import save
from walklab.steering.dependencies import DEPENDENCIES
from walklab.storage import read_table

if __name__ == "__main__":
    with job(snakemake):
        names = snakemake.params.dependencies["names"]

        def of_index(table, index):
            return table[[f"{index}_{name}" for name in names]].set_axis(names, axis=1)

        training = pd.concat(map(read_table, snakemake.input.training), ignore_index=True)
        run_time = {Path(path).parent.name: of_index(read_table(path), "planned") for path in snakemake.input.scenarios}
        units = {name: DEPENDENCIES[name].unit for name in names}
        figure = dependency_clouds(of_index(training, "captured"), of_index(training, "planned"), run_time, units)
        save(figure, *snakemake.output)
