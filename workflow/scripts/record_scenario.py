"""Record experiment 2 in one scenario."""

from adapter import job
from capture_inputs import constants_of, participants_of_group, people_of
from walklab.capture.io import write_poses, write_truth
from walklab.capture.scenario import ScenarioDesign, record_scenario
from walklab.geometry.plans import load_plan
from walklab.geometry.standing import Standing

if __name__ == "__main__":
    with job(snakemake):
        poses, truth = record_scenario(
            participants_of_group(snakemake.input.participants, "scenarios"),
            load_plan(snakemake.input.plan),
            ScenarioDesign(**snakemake.params.record_scenario),
            constants_of(snakemake.params.generator),
            snakemake.params.seed,
            int(snakemake.wildcards.replicate),
            standing=Standing(**snakemake.params.standing),
            make_person=people_of(snakemake.input.shapes, snakemake.params.seed),
        )
        write_poses(poses, snakemake.output.poses)
        write_truth(truth, snakemake.output.truth)
