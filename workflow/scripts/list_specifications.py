"""List the specifications of the multiverse with all their settings."""

from adapter import job
from walklab.multiverse.budget import Walked, affordable
from walklab.multiverse.choices import Choices
from walklab.multiverse.specifications import specifications
from walklab.multiverse.table import specification_table
from walklab.randomness import generator
from walklab.storage import write_table

if __name__ == "__main__":
    with job(snakemake):
        params = snakemake.params
        rng, budget_minutes = generator(params.seed, "multiverse"), params.multiverse["budget_minutes"]
        found = specifications(Choices(**params.baseline), params.multiverse["combinations"], rng, params.multiverse["vary"])
        print(affordable(budget_minutes, len(found), Walked(**params.study)).checked(budget_minutes))
        write_table(specification_table(found), snakemake.output.specifications)
