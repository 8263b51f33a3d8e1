"""Trials, statistics, the analyses of section 8 and the verdict on each claim."""

MODEL_INPUTS = {
    "walks": stage("extract_scenario", "walks.parquet", "scenario"),
    "samples": stage("extract_scenario", "samples.parquet", "scenario"),
    "routes": stage("plan_scenario", "routes.parquet", "scenario"),
    "vectors": stage("plan_scenario", "vectors.parquet", "scenario"),
    "model": rules.train_model.output.model,
    "static": rules.fit_static.output.static,
}
# The studies of section 8 are all made on the first scenario, as in the paper.
FIRST_SCENARIO = {
    name: path.replace("{scenario}", SCENARIOS[0])
    for name, path in MODEL_INPUTS.items()
}
FIRST_SCENARIO["plan"] = CONFIG["scenarios"][SCENARIOS[0]]
TRIALS = section("seed", "planner", "space", "dependencies", "standing", "metric")


rule simulate_trials:
    input:
        **MODEL_INPUTS,
        plan=lambda wildcards: CONFIG["scenarios"][wildcards.scenario],
        calibration=stage("calibrate_model", "calibration.json"),
    output:
        trials=stage("simulate_trials", "trials.parquet", "scenario"),
    log:
        stage("simulate_trials", "log.txt", "scenario"),
    params:
        **TRIALS,
        code=code("simulate_trials.py"),
    script:
        "../scripts/simulate_trials.py"


rule floor_grid:
    input:
        walks=MODEL_INPUTS["walks"],
        samples=MODEL_INPUTS["samples"],
        routes=MODEL_INPUTS["routes"],
    output:
        floor=stage("floor_grid", "floor.csv", "scenario"),
    log:
        stage("floor_grid", "log.txt", "scenario"),
    params:
        **section("planner", "space", "standing", "metric"),
        code=code("floor_grid.py"),
    script:
        "../scripts/floor_grid.py"


rule compare_models:
    input:
        trials=rules.simulate_trials.output.trials,
    output:
        description=stage("compare_models", "description.csv", "scenario"),
        description_by_hull=stage(
            "compare_models", "description_by_hull.csv", "scenario"
        ),
        percentiles=stage("compare_models", "percentiles.csv", "scenario"),
        reductions=stage("compare_models", "reductions.csv", "scenario"),
        comparisons=stage("compare_models", "comparisons.csv", "scenario"),
        mixed=stage("compare_models", "mixed_model.csv", "scenario"),
    log:
        stage("compare_models", "log.txt", "scenario"),
    params:
        **section("seed", "statistics"),
        code=code("compare_models.py"),
    script:
        "../scripts/compare_models.py"


rule ablate_parameters:
    input:
        **FIRST_SCENARIO,
        training_walks=expand(
            stage(WALKS, "walks.parquet", "shard"), shard=SHARDS, allow_missing=True
        ),
        training_samples=expand(
            stage(WALKS, "samples.parquet", "shard"), shard=SHARDS, allow_missing=True
        ),
        training_routes=expand(
            rules.plan_training.output.routes, shard=SHARDS, allow_missing=True
        ),
        maps=expand(rules.score_maps.output.maps, shard=SHARDS, allow_missing=True),
        calibration=stage("calibrate_model", "calibration.json"),
    output:
        ablations=stage("ablate_parameters", "ablations.csv"),
        # The same with P_Prob (calibrated), which is not in the paper.
        calibrated=stage("ablate_parameters", "ablations_calibrated.csv"),
        trials=stage("ablate_parameters", "trials.parquet"),
    log:
        stage("ablate_parameters", "log.txt"),
    params:
        **TRIALS,
        **section("blending_space", "model", "ablate_parameters", "statistics"),
        code=code("ablate_parameters.py"),
    script:
        "../scripts/ablate_parameters.py"


rule leave_out:
    input:
        space=rules.build_space.output.space,
        maps=expand(rules.score_maps.output.maps, shard=SHARDS, allow_missing=True),
    output:
        summary=stage("leave_out", "summary.csv"),
        errors=stage("leave_out", "errors.parquet"),
    log:
        stage("leave_out", "log.txt"),
    params:
        **section(
            "seed",
            "dependencies",
            "blending_space",
            "model",
            "leave_out",
            "statistics",
        ),
        code=code("leave_out.py"),
    script:
        "../scripts/leave_out.py"


rule sweep_neighbours:
    input:
        **FIRST_SCENARIO,
        calibration=stage("calibrate_model", "calibration.json"),
    output:
        errors=stage("sweep_neighbours", "errors.csv"),
        calibrated=stage("sweep_neighbours", "errors_calibrated.csv"),
        trials=stage("sweep_neighbours", "trials.parquet"),
        # A measured time differs from run to run; it is kept apart from the data files, which do not.
        timings=stage("sweep_neighbours", "timings.csv"),
    log:
        stage("sweep_neighbours", "log.txt"),
    params:
        **TRIALS,
        **section("sweep_neighbours", "statistics"),
        code=code("sweep_neighbours.py"),
    script:
        "../scripts/sweep_neighbours.py"


rule simulate_long_distance:
    input:
        times=rules.record_long_distance.output.times,
    output:
        draws=stage("simulate_long_distance", "draws.parquet"),
        table=stage("simulate_long_distance", "table.csv"),
        optimum=stage("simulate_long_distance", "optimum.csv"),
        sharpness=stage("simulate_long_distance", "sharpness.csv"),
    log:
        stage("simulate_long_distance", "log.txt"),
    params:
        **section("seed", "long_distance", "statistics", "standing"),
        code=code("simulate_long_distance.py"),
    script:
        "../scripts/simulate_long_distance.py"


rule count_distances:
    input:
        vectors=expand(
            rules.plan_scenario.output.vectors, scenario=SCENARIOS, allow_missing=True
        ),
    output:
        classes=stage("count_distances", "classes.csv"),
    log:
        stage("count_distances", "log.txt"),
    params:
        **section("scenarios"),
        code=code("count_distances.py"),
    script:
        "../scripts/count_distances.py"


rule estimate_saving:
    input:
        trials=rules.simulate_trials.output.trials.replace("{scenario}", SCENARIOS[0]),
    output:
        saving=stage("estimate_saving", "saving.csv"),
    log:
        stage("estimate_saving", "log.txt"),
    params:
        **section("seed", "statistics"),
        code=code("estimate_saving.py"),
    script:
        "../scripts/estimate_saving.py"


rule cross_validate:
    input:
        maps=expand(rules.score_maps.output.maps, shard=SHARDS, allow_missing=True),
        walks=expand(
            stage(WALKS, "walks.parquet", "shard"), shard=SHARDS, allow_missing=True
        ),
        samples=expand(
            stage(WALKS, "samples.parquet", "shard"), shard=SHARDS, allow_missing=True
        ),
        routes=expand(
            rules.plan_training.output.routes, shard=SHARDS, allow_missing=True
        ),
    output:
        predictions=stage("cross_validate", "predictions.parquet"),
        scores=stage("cross_validate", "scores.csv"),
        summary=stage("cross_validate", "summary.csv"),
        calibration=stage("cross_validate", "calibration.csv"),
    log:
        stage("cross_validate", "log.txt"),
    params:
        **TRIALS,
        **section("blending_space", "model", "fit_static", "statistics"),
        code=code("cross_validate.py"),
    script:
        "../scripts/cross_validate.py"
