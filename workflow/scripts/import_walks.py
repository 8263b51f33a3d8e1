"""Read real or own walks and deal their participants out to the shards."""

import os

from adapter import job
from walklab.capture import acclaim, own
from walklab.capture.imported_walks import ImportRules
from walklab.capture.walks import ACCEPTED, write_walks
from walklab.errors import InputError
from walklab.geometry.standing import Standing


def read(params):
    source, path = params.source, os.path.expandvars(params.source["path"])
    rules = ImportRules(smoothing_sigma_frames=params.extract_walks["smoothing_sigma_frames"])
    shared = {
        "standing": Standing(**params.standing),
        "curvature_scale_m": params.dependencies["curvature_scale_m"],
        "rules": rules,
        "dataset": params.run,
    }
    if source["kind"] == "acclaim":
        return acclaim.import_walks(path, source["file_unit_m"], source["rate_hz"] or acclaim.CMU_RATE_HZ, **shared)
    columns = own.OwnColumns(**source["columns"])
    units = {name: source[name] for name in ("length_unit", "height_unit", "time_unit", "rate_hz")}
    return own.import_walks(path, columns, **units, **shared)


if __name__ == "__main__":
    with job(snakemake):
        walks, samples = read(snakemake.params)
        people = sorted(walks.loc[walks["rejection"] == ACCEPTED, "participant"].unique())
        if len(people) < 2:
            raise InputError(f"{snakemake.params.source['path']}: {len(people)} participants with walks; at least 2 are needed")
        shards = len(snakemake.output.walks)
        for shard in range(shards):
            mine = walks[walks["participant"].isin(people[shard::shards])]
            names = set(mine["walk"])
            write_walks(
                mine, samples[samples["walk"].isin(names)], snakemake.output.walks[shard], snakemake.output.samples[shard]
            )
