"""Measure the synthetic walks of experiment 1 beside recordings of real people, where these are present."""

from adapter import job
from walklab.capture.realism import compare, synthetic_samples, value_table
from walklab.capture.recordings import recorded_samples
from walklab.capture.walks import read_walks
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        pairs = zip(snakemake.input.walks, snakemake.input.samples, strict=True)
        walks = [walk for files in pairs for walk in read_walks(*files)]
        synthetic = synthetic_samples(sorted(walks, key=lambda walk: str(walk.row["walk"])))
        recorded, absent = recorded_samples(snakemake.params.data)
        for reason in absent:
            print(reason)
        write_table(compare([*synthetic, *recorded], absent), snakemake.output.realism)
        write_table(value_table([*synthetic, *recorded]), snakemake.output.values)
