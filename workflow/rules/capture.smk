"""Recordings and the walks in them."""

# Walks made by either generator go through the paper's study, captured ones through leave-one-subject-out.
RESAMPLED = CONFIG["source"]["kind"] == "resampled"
SYNTHETIC = RESAMPLED or CONFIG["source"]["kind"] == "synthetic"
SHAPES = first(stage("import_shapes", "shapes.parquet")) if RESAMPLED else []
TURNS = [f"turn_{angle}" for angle in CONFIG["record_training"]["turning_angles_deg"]]
WALKS = "extract_training" if SYNTHETIC else "import_walks"
TURN_PLANS = [shipped(f"config/scenes/{turn}.yaml") for turn in TURNS]
TRAINING_PLANS = TURN_PLANS if SYNTHETIC else CONFIG["source"]["plans"]


rule draw_participants:
    output:
        participants=stage("draw_participants", "participants.parquet"),
    log:
        stage("draw_participants", "log.txt"),
    params:
        **section("seed", "participants"),
        code=code("draw_participants.py"),
    script:
        "../scripts/draw_participants.py"


rule import_shapes:
    input:
        recordings,
    output:
        shapes=first(stage("import_shapes", "shapes.parquet")),
    log:
        first(stage("import_shapes", "log.txt")),
    params:
        **section("source"),
        code=code("import_shapes.py"),
    script:
        "../scripts/import_shapes.py"


rule record_training:
    input:
        shapes=SHAPES,
        participants=rules.draw_participants.output.participants,
        plans=TURN_PLANS,
    output:
        recording=bulky(stage("record_training", "recording.parquet", "shard")),
        truth=stage("record_training", "truth.parquet", "shard"),
    log:
        stage("record_training", "log.txt", "shard"),
    params:
        **section("seed", "record_training", "generator", "shards", "standing"),
        code=code("record_training.py"),
    script:
        "../scripts/record_training.py"


rule record_scenario:
    input:
        shapes=SHAPES,
        participants=rules.draw_participants.output.participants,
        plan=lambda wildcards: CONFIG["scenarios"][wildcards.scenario],
    output:
        poses=bulky(stage("record_scenario", "poses.parquet", "scenario")),
        truth=stage("record_scenario", "truth.parquet", "scenario"),
    log:
        stage("record_scenario", "log.txt", "scenario"),
    params:
        **section("seed", "record_scenario", "generator", "standing"),
        code=code("record_scenario.py"),
    script:
        "../scripts/record_scenario.py"


rule record_long_distance:
    input:
        participants=rules.draw_participants.output.participants,
    output:
        times=stage("record_long_distance", "times.parquet"),
    log:
        stage("record_long_distance", "log.txt"),
    params:
        **section("seed", "source", "record_long_distance", "generator"),
        code=code("record_long_distance.py"),
    script:
        "../scripts/record_long_distance.py"


rule extract_training:
    input:
        participants=rules.draw_participants.output.participants,
        recording=rules.record_training.output.recording,
        truth=rules.record_training.output.truth,
        plans=rules.record_training.input.plans,
    output:
        walks=stage("extract_training", "walks.parquet", "shard"),
        samples=stage("extract_training", "samples.parquet", "shard"),
        boundaries=stage("extract_training", "boundaries.parquet", "shard"),
    log:
        stage("extract_training", "log.txt", "shard"),
    params:
        **section("record_training", "extract_walks", "standing", "dependencies"),
        code=code("extract_training.py"),
    script:
        "../scripts/extract_training.py"


rule extract_scenario:
    input:
        participants=rules.draw_participants.output.participants,
        poses=rules.record_scenario.output.poses,
        truth=rules.record_scenario.output.truth,
        plan=rules.record_scenario.input.plan,
    output:
        walks=stage("extract_scenario", "walks.parquet", "scenario"),
        samples=stage("extract_scenario", "samples.parquet", "scenario"),
        boundaries=stage("extract_scenario", "boundaries.parquet", "scenario"),
    log:
        stage("extract_scenario", "log.txt", "scenario"),
    params:
        **section("record_scenario", "extract_walks", "standing", "dependencies"),
        code=code("extract_scenario.py"),
    script:
        "../scripts/extract_scenario.py"


rule import_walks:
    input:
        source_files,
    output:
        walks=expand(
            stage("import_walks", "walks.parquet", "shard"),
            shard=SHARDS,
            allow_missing=True,
        ),
        samples=expand(
            stage("import_walks", "samples.parquet", "shard"),
            shard=SHARDS,
            allow_missing=True,
        ),
    log:
        stage("import_walks", "log.txt"),
    params:
        **section("run", "source", "standing", "dependencies", "extract_walks"),
        code=code("import_walks.py"),
    script:
        "../scripts/import_walks.py"


rule summarise_capture:
    input:
        walks=[
            *expand(
                rules.extract_training.output.walks, shard=SHARDS, allow_missing=True
            ),
            *expand(
                rules.extract_scenario.output.walks,
                scenario=SCENARIOS,
                allow_missing=True,
            ),
        ],
        boundaries=[
            *expand(
                rules.extract_training.output.boundaries,
                shard=SHARDS,
                allow_missing=True,
            ),
            *expand(
                rules.extract_scenario.output.boundaries,
                scenario=SCENARIOS,
                allow_missing=True,
            ),
        ],
    output:
        summary=stage("summarise_capture", "capture.csv"),
        rejections=stage("summarise_capture", "rejections.csv"),
    log:
        stage("summarise_capture", "log.txt"),
    params:
        code=code("summarise_capture.py"),
    script:
        "../scripts/summarise_capture.py"


# The first population of the synthetic capture beside recordings of real people, as many as there are under WALKLAB_DATA.
rule measure_realism:
    input:
        walks=expand(first(rules.extract_training.output.walks), shard=SHARDS),
        samples=expand(first(rules.extract_training.output.samples), shard=SHARDS),
        recordings=recordings,
    output:
        realism=report(
            f"{RUN}/realism.csv", caption="../report/table.rst", category="Tables"
        ),
        values=first(stage("measure_realism", "values.parquet")),
    log:
        first(stage("measure_realism", "log.txt")),
    params:
        code=code("measure_realism.py"),
        data=os.path.expandvars("$WALKLAB_DATA"),
    script:
        "../scripts/measure_realism.py"
