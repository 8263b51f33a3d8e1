"""Derive the centre of mass from the belt controller and find the walks of one scenario."""

from adapter import job
from capture_inputs import participants_of_group
from walklab.capture.centre_of_mass import from_belt_pose
from walklab.capture.io import read_poses, read_truth
from walklab.capture.segmentation import SegmentationRules, compare_boundaries, extract_walks
from walklab.capture.walks import write_walks
from walklab.geometry.plans import load_plan
from walklab.geometry.standing import Standing
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        participants = participants_of_group(snakemake.input.participants, "scenarios")
        offset_m = snakemake.params.record_scenario["controller_offset_m"]
        plan = load_plan(snakemake.input.plan)
        walks, samples = extract_walks(
            from_belt_pose(read_poses(snakemake.input.poses), participants, offset_m),
            participants,
            Standing(**snakemake.params.standing),
            SegmentationRules(**snakemake.params.extract_walks),
            snakemake.params.dependencies["curvature_scale_m"],
            {plan.scene.name: {name: station.position_m for name, station in plan.stations.items()}},
        )
        write_walks(walks, samples, snakemake.output.walks, snakemake.output.samples)
        rate_hz = snakemake.params.record_scenario["rate_hz"]
        errors = compare_boundaries(walks, read_truth(snakemake.input.truth), rate_hz)
        write_table(errors, snakemake.output.boundaries)
