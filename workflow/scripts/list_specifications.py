"""List the specifications of the multiverse with all their settings."""

from adapter import job
from walklab.capture.scenario import ScenarioDesign
from walklab.capture.training import TrainingDesign
from walklab.multiverse.budget import affordable
from walklab.multiverse.choices import Choices
from walklab.multiverse.specifications import specification_table, specifications
from walklab.randomness import generator
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        params = snakemake.params
        rng, budget_minutes = generator(params.seed, "multiverse"), params.multiverse["budget_minutes"]
        found = specifications(Choices(**params.baseline), params.multiverse["combinations"], rng, params.multiverse["vary"])
        designs = TrainingDesign(**params.record_training), ScenarioDesign(**params.record_scenario)
        people = params.participants["training"]["count"]
        size = affordable(budget_minutes, len(found), *designs, people, params.walks_per_set).checked(budget_minutes)
        print(size)
        write_table(specification_table(found), snakemake.output.specifications)
