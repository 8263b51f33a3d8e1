"""Record experiment 1 for one shard of its participants."""

from adapter import job
from capture_inputs import constants_of, participants_of_group, participants_of_shard, people_of, plans_by_scene
from walklab.capture.io import write_recording, write_truth
from walklab.capture.training import TrainingDesign, record_training
from walklab.geometry.standing import Standing

if __name__ == "__main__":
    with job(snakemake):
        everyone = participants_of_group(snakemake.input.participants, "training")
        recording, truth = record_training(
            participants_of_shard(everyone, int(snakemake.wildcards.shard), snakemake.params.shards),
            TrainingDesign(**snakemake.params.record_training),
            plans_by_scene(snakemake.input.plans),
            constants_of(snakemake.params.generator),
            snakemake.params.seed,
            int(snakemake.wildcards.replicate),
            standing=Standing(**snakemake.params.standing),
            make_person=people_of(snakemake.input.shapes, snakemake.params.seed),
            all_participants=tuple(everyone["participant"]),
        )
        write_recording(recording, snakemake.output.recording)
        write_truth(truth, snakemake.output.truth)
