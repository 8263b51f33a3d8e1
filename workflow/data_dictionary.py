"""The data dictionary as Markdown: checked tables from their schemas, the other products in words."""

import pandera.pandas as pa

from walklab.capture import io, real_shapes, walks

TABLES = {
    "Participants": ("draw_participants/participants.parquet", io.PARTICIPANTS),
    "Recordings of experiment 1": ("record_training/<shard>/recording.parquet", io.RECORDING),
    "Poses of experiment 2": ("record_scenario/<scenario>/poses.parquet", io.POSES),
    "Truth of the generator": ("record_*/**/truth.parquet, read by the checks of the segmentation alone", io.TRUTH),
    "Shapes of recorded walks": ("results/resampled/0/import_shapes/shapes.parquet", real_shapes.SHAPES),
    "Long distances": ("record_long_distance/times.parquet", io.TRAVEL_TIMES),
    "Walks": ("extract_*/**/walks.parquet, import_walks/<shard>/walks.parquet", walks.WALKS),
    "Samples of the walks": ("extract_*/**/samples.parquet, import_walks/<shard>/samples.parquet", walks.SAMPLES),
}

# The longest ending decides.
UNITS = {
    "_m": "m",
    "_s": "s",
    "_m_s": "m/s",
    "_1_m": "1/m",
    "_kg": "kg",
    "_years": "years",
}

INTRODUCTION = """# Data dictionary

Where no folder is named, files are in `results/<run>/<replicate>/`. Tables are Parquet and are held to these schemas when they are
read; a row that breaks one is named with file, column and row. This page is generated from the schemas by `make manual`.
"""

OTHERS = """## Other products

| file | what it holds |
|---|---|
| `score_maps/<shard>/maps.nc` | suitability maps: dimensions walk and one per steering parameter (`v`, `a`, `omega`), m_Euclid in metres, a coordinate per dependency |
| `build_space/blending_space.nc` | the blending space: the same with up-sampled entries, their parents and weights, and the scaling of the dependencies |
| `results/<run>/model.safetensors` | the run-time model: see [model](model.md) |
| `simulate_trials/<scenario>/trials.parquet` | a row per walk and model: drawn parameters, signed and absolute travel-time error (s), arrival, trajectory error (m), `inside_hull` |
| `results/<run>/claims.csv` | a row per claim: id, section, statement, published, ours, `ours_low` and `ours_high` (95 %), verdict, note |
| `results/<run>/scores.csv` | proper scores per forecast, scenario and part of the training range (`hull`): CRPS (s), energy score (m), coverage, bias (s), each with a 95 % interval |
| `results/<run>/realism.csv` | a row per measure, class of distance and recording: medians, quartiles and numbers of synthetic and recorded walks, Kolmogorov-Smirnov distance, remark (why a recording is absent) |
| `results/resampled/verdicts.csv` | a row per claim: value and verdict under synthetic walks (`ours_other`, `verdict_other`) and under walks resampled from recordings, and whether the verdicts agree |
| `results/replicates/claims.csv` | a row per claim: in how many populations it was checkable (`replicates`), reproduced, and its direction held, each with the ends of the share's Wilson interval; median and range of ours |
| `results/replicates/scores.csv` | a row per scenario, hull, measure and forecast: mean over populations (`value`), 95 % interval, sd, `below_zero` (populations in which it is negative); `crps_difference_s` is the CRPS (s) of `model` minus that of `against` |
| `results/recovery/recovery.csv` | a row per number of walks, resolution, repetition, task, reading of the maps, measure (`ks`, `bias`, `spread`, `energy`) and parameter |
| `results/<run>/run.json` | the record of the run: see [runs](runs.md) |
"""


def data_dictionary() -> str:
    """The page docs/data.md."""
    tables = [_section(title, path, schema) for title, (path, schema) in TABLES.items()]
    return "\n".join([INTRODUCTION, *tables, OTHERS])


def _section(title: str, path: str, schema: pa.DataFrameSchema) -> str:
    rows = [
        f"| `{name}` | {column.dtype} | {_unit(name)} | {_rule(column)} | {column.description} |"
        for name, column in schema.columns.items()
    ]
    return "\n".join(
        [f"## {title}", "", f"`{path}`", "", "| column | type | unit | rule | meaning |", "|---|---|---|---|---|", *rows, ""]
    )


def _unit(name: str) -> str:
    endings = [ending for ending in UNITS if name.endswith(ending)]
    return UNITS[max(endings, key=len)] if endings else "-"


def _rule(column: pa.Column) -> str:
    rules = [str(check.error) for check in column.checks or []]
    rules += ["unique"] if column.unique else []
    rules += ["may be missing"] if column.nullable else []
    return ", ".join(rules) or "-"
