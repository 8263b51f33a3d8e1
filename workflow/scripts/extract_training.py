"""Find the walks in the recordings of experiment 1."""

from adapter import job
from capture_inputs import participants_of_group
from walklab.capture.io import read_recording, read_truth
from walklab.capture.segmentation import SegmentationRules, compare_boundaries, extract_walks
from walklab.capture.walks import write_walks
from walklab.geometry.standing import Standing
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        recording = read_recording(snakemake.input.recording)
        walks, samples = extract_walks(
            recording,
            participants_of_group(snakemake.input.participants, "training"),
            Standing(**snakemake.params.standing),
            SegmentationRules(**snakemake.params.extract_walks),
            snakemake.params.dependencies["curvature_scale_m"],
        )
        write_walks(walks, samples, snakemake.output.walks, snakemake.output.samples)
        rate_hz = snakemake.params.record_training["rate_hz"]
        errors = compare_boundaries(walks, read_truth(snakemake.input.truth), rate_hz)
        write_table(errors, snakemake.output.boundaries)
