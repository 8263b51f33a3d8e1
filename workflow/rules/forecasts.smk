"""Learned sharpness, and proper scores of all forecasts of the held-out scenarios."""

TRAINING_FILES = {
    "training_walks": expand(
        stage(WALKS, "walks.parquet", "shard"), shard=SHARDS, allow_missing=True
    ),
    "training_samples": expand(
        stage(WALKS, "samples.parquet", "shard"), shard=SHARDS, allow_missing=True
    ),
    "training_routes": expand(
        rules.plan_training.output.routes, shard=SHARDS, allow_missing=True
    ),
    "maps": expand(rules.score_maps.output.maps, shard=SHARDS, allow_missing=True),
}


# Nothing of experiment 2 is among its inputs.
rule calibrate_model:
    input:
        **TRAINING_FILES,
        space=rules.build_space.output.space,
        static=rules.fit_static.output.static,
    output:
        calibration=stage("calibrate_model", "calibration.json"),
        candidates=stage("calibrate_model", "candidates.csv"),
        residuals=stage("calibrate_model", "residuals.parquet"),
    log:
        stage("calibrate_model", "log.txt"),
    params:
        **TRIALS,
        **section("blending_space", "model", "calibrate_model"),
        code=code("calibrate_model.py"),
    script:
        "../scripts/calibrate_model.py"


rule score_forecasts:
    input:
        **TRAINING_FILES,
        **{
            name: expand(MODEL_INPUTS[name], scenario=SCENARIOS, allow_missing=True)
            for name in ("walks", "samples", "routes", "vectors")
        },
        model=rules.train_model.output.model,
        trials=expand(
            rules.simulate_trials.output.trials, scenario=SCENARIOS, allow_missing=True
        ),
        calibration=rules.calibrate_model.output.calibration,
        candidates=rules.calibrate_model.output.candidates,
        residuals=rules.calibrate_model.output.residuals,
    output:
        predictions=stage("score_forecasts", "predictions.parquet"),
        scores=stage("score_forecasts", "scores.csv"),
        calibration=stage("score_forecasts", "calibration.csv"),
    log:
        stage("score_forecasts", "log.txt"),
    params:
        **TRIALS,
        **section("blending_space", "scenarios", "statistics"),
        code=code("score_forecasts.py"),
    script:
        "../scripts/score_forecasts.py"


# The trials of the paper's models by |dt|, under the same tests as the forecasts; real walks have no scenarios.
COMPARED_TRIALS = (
    {
        "trials": expand(
            rules.simulate_trials.output.trials, scenario=SCENARIOS, allow_missing=True
        )
    }
    if SYNTHETIC
    else {}
)
TRIAL_TESTS = (
    {"trial_tests": stage("compare_forecasts", "trial_tests.csv")} if SYNTHETIC else {}
)


rule compare_forecasts:
    input:
        **COMPARED_TRIALS,
        # Real walks are no scenario: everybody is left out in turn.
        predictions=(
            rules.score_forecasts if SYNTHETIC else rules.cross_validate
        ).output.predictions,
    output:
        **TRIAL_TESTS,
        tests=stage("compare_forecasts", "tests.csv"),
    log:
        stage("compare_forecasts", "log.txt"),
    params:
        **section("seed", "scenarios", "statistics"),
        code=code("compare_forecasts.py"),
    script:
        "../scripts/compare_forecasts.py"
