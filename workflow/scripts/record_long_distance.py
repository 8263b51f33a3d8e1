"""Record the travel times of the long walks."""

from adapter import job
from capture_inputs import constants_of, participants_of_group
from walklab.capture.io import write_travel_times
from walklab.capture.long_distance import LongDistanceDesign, record_long_distance
from walklab.capture.resampling import resample_long_distance

if __name__ == "__main__":
    with job(snakemake):
        record = resample_long_distance if snakemake.params.source["kind"] == "resampled" else record_long_distance
        times = record(
            participants_of_group(snakemake.input.participants, "long_distance"),
            LongDistanceDesign(**snakemake.params.record_long_distance),
            constants_of(snakemake.params.generator),
            snakemake.params.seed,
            int(snakemake.wildcards.replicate),
        )
        write_travel_times(times, snakemake.output.times)
