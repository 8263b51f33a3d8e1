"""Routes, suitability maps, blending space and motion models."""

SHARED = ("planner", "body", "dependencies", "space")


rule plan_training:
    input:
        walks=stage(WALKS, "walks.parquet", "shard"),
        samples=stage(WALKS, "samples.parquet", "shard"),
        plans=TURN_PLANS,
    output:
        routes=stage("plan_training", "routes.parquet", "shard"),
        vectors=stage("plan_training", "vectors.parquet", "shard"),
    log:
        stage("plan_training", "log.txt", "shard"),
    params:
        **section(*SHARED),
        code=code("plan_walks.py"),
    script:
        "../scripts/plan_walks.py"


rule plan_scenario:
    input:
        walks=stage("extract_scenario", "walks.parquet", "scenario"),
        samples=stage("extract_scenario", "samples.parquet", "scenario"),
        plans=lambda wildcards: [CONFIG["scenarios"][wildcards.scenario]],
    output:
        routes=stage("plan_scenario", "routes.parquet", "scenario"),
        vectors=stage("plan_scenario", "vectors.parquet", "scenario"),
    log:
        stage("plan_scenario", "log.txt", "scenario"),
    params:
        **section(*SHARED),
        code=code("plan_walks.py"),
    script:
        "../scripts/plan_walks.py"


rule score_maps:
    input:
        walks=stage(WALKS, "walks.parquet", "shard"),
        samples=stage(WALKS, "samples.parquet", "shard"),
        routes=rules.plan_training.output.routes,
        vectors=rules.plan_training.output.vectors,
    output:
        maps=stage("score_maps", "maps.nc", "shard"),
    log:
        stage("score_maps", "log.txt", "shard"),
    params:
        **section("planner", "space", "metric", "standing", "dependencies"),
        code=code("score_maps.py"),
    script:
        "../scripts/score_maps.py"


rule build_space:
    input:
        maps=expand(rules.score_maps.output.maps, shard=SHARDS, allow_missing=True),
    output:
        space=stage("build_space", "blending_space.nc"),
        density=stage("build_space", "density.csv"),
    log:
        stage("build_space", "log.txt"),
    params:
        **section("seed", "space", "dependencies", "blending_space"),
        code=code("build_space.py"),
    script:
        "../scripts/build_space.py"


rule fit_static:
    input:
        walks=expand(
            stage(WALKS, "walks.parquet", "shard"), shard=SHARDS, allow_missing=True
        ),
        samples=expand(
            stage(WALKS, "samples.parquet", "shard"), shard=SHARDS, allow_missing=True
        ),
        routes=expand(
            rules.plan_training.output.routes, shard=SHARDS, allow_missing=True
        ),
        maps=expand(rules.score_maps.output.maps, shard=SHARDS, allow_missing=True),
    output:
        static=stage("fit_static", "static.json"),
        optimum=stage("fit_static", "optimum.csv"),
    log:
        stage("fit_static", "log.txt"),
    params:
        **section(
            "seed",
            "planner",
            "space",
            "metric",
            "standing",
            "fit_static",
            "statistics",
        ),
        code=code("fit_static.py"),
    script:
        "../scripts/fit_static.py"


rule train_model:
    input:
        space=rules.build_space.output.space,
    output:
        model=stage("train_model", "model.safetensors"),
    log:
        stage("train_model", "log.txt"),
    params:
        **section("run", "seed", "model"),
        code=code("train_model.py"),
    script:
        "../scripts/train_model.py"
