"""Take path shapes, swings of speed, starts and stops from the recordings of real people."""

import os

from adapter import job
from walklab.capture.real_shapes import write_shapes
from walklab.capture.recorded_shapes import import_shapes

if __name__ == "__main__":
    with job(snakemake):
        write_shapes(import_shapes(os.path.expandvars(snakemake.params.source["path"])), snakemake.output.shapes)
