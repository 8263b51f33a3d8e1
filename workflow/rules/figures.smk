"""Figures of one population, each the counterpart of one of the paper's."""

TRAINING = {
    "walks": expand(first(stage(WALKS, "walks.parquet", "shard")), shard=SHARDS),
    "samples": expand(first(stage(WALKS, "samples.parquet", "shard")), shard=SHARDS),
    "vectors": expand(first(rules.plan_training.output.vectors), shard=SHARDS),
    "maps": expand(first(rules.score_maps.output.maps), shard=SHARDS),
}
SCENARIO_FILES = {
    name: expand(first(MODEL_INPUTS[name]), scenario=SCENARIOS)
    for name in ("walks", "samples", "routes", "vectors")
}


rule draw_fig03:
    input:
        classes=first(rules.count_distances.output.classes),
        paper=PAPER,
    output:
        figure("fig03", "Setting"),
    log:
        first(stage("draw_fig03", "log.txt")),
    priority: LAST
    params:
        code=code("draw_fig03.py"),
    script:
        "../scripts/draw_fig03.py"


rule draw_fig04:
    input:
        walks=TRAINING["walks"],
        samples=TRAINING["samples"],
        plans=rules.record_training.input.plans,
    output:
        figure("fig04", "Capture"),
    log:
        first(stage("draw_fig04", "log.txt")),
    priority: LAST
    params:
        code=code("draw_fig04.py"),
    script:
        "../scripts/draw_fig04.py"


rule draw_realism:
    input:
        values=rules.measure_realism.output.values,
    output:
        figure("realism", "Capture"),
    log:
        first(stage("draw_realism", "log.txt")),
    priority: LAST
    params:
        code=code("draw_realism.py"),
    script:
        "../scripts/draw_realism.py"


rule draw_fig05:
    input:
        maps=TRAINING["maps"],
    output:
        figure("fig05", "Model"),
    log:
        first(stage("draw_fig05", "log.txt")),
    priority: LAST
    params:
        **section("blending_space"),
        code=code("draw_fig05.py"),
    script:
        "../scripts/draw_fig05.py"


rule draw_fig06:
    input:
        space=first(rules.build_space.output.space),
    output:
        figure("fig06", "Model"),
    log:
        first(stage("draw_fig06", "log.txt")),
    priority: LAST
    params:
        code=code("draw_fig06.py"),
    script:
        "../scripts/draw_fig06.py"


rule draw_dependency_clouds:
    input:
        training=TRAINING["vectors"],
        scenarios=SCENARIO_FILES["vectors"],
    output:
        figure("dependency_clouds", "Model"),
    log:
        first(stage("draw_dependency_clouds", "log.txt")),
    priority: LAST
    params:
        **section("dependencies"),
        code=code("draw_dependency_clouds.py"),
    script:
        "../scripts/draw_dependency_clouds.py"


rule draw_fig08:
    input:
        model=first(rules.train_model.output.model),
    output:
        figure("fig08", "Model"),
    log:
        first(stage("draw_fig08", "log.txt")),
    priority: LAST
    params:
        **section("draw_fig08"),
        code=code("draw_fig08.py"),
    script:
        "../scripts/draw_fig08.py"


rule draw_fig09:
    input:
        **{name: first(path) for name, path in FIRST_SCENARIO.items()},
    output:
        figure("fig09", "Model"),
    log:
        first(stage("draw_fig09", "log.txt")),
    priority: LAST
    params:
        **TRIALS,
        code=code("draw_fig09.py"),
    script:
        "../scripts/draw_fig09.py"


rule draw_fig10:
    input:
        **SCENARIO_FILES,
        model=first(rules.train_model.output.model),
        static=first(rules.fit_static.output.static),
        plans=list(CONFIG["scenarios"].values()),
    output:
        figure("fig10", "Evaluation"),
    log:
        first(stage("draw_fig10", "log.txt")),
    priority: LAST
    params:
        **section("seed", "scenarios", "planner", "space", "dependencies"),
        code=code("draw_fig10.py"),
    script:
        "../scripts/draw_fig10.py"


rule draw_fig13:
    input:
        ablations=first(rules.ablate_parameters.output.ablations),
        calibrated=first(rules.ablate_parameters.output.calibrated),
        paper=PAPER,
    output:
        figure("fig13", "Analyses"),
    log:
        first(stage("draw_fig13", "log.txt")),
    priority: LAST
    params:
        code=code("draw_fig13.py"),
    script:
        "../scripts/draw_fig13.py"


rule draw_fig14:
    input:
        errors=first(rules.sweep_neighbours.output.errors),
        timings=first(rules.sweep_neighbours.output.timings),
        calibrated=first(rules.sweep_neighbours.output.calibrated),
        paper=PAPER,
    output:
        figure("fig14", "Analyses"),
    log:
        first(stage("draw_fig14", "log.txt")),
    priority: LAST
    params:
        code=code("draw_fig14.py"),
    script:
        "../scripts/draw_fig14.py"


rule draw_fig15:
    input:
        draws=first(rules.simulate_long_distance.output.draws),
        paper=PAPER,
    output:
        figure("fig15", "Analyses"),
    log:
        first(stage("draw_fig15", "log.txt")),
    priority: LAST
    params:
        code=code("draw_fig15.py"),
    script:
        "../scripts/draw_fig15.py"


rule draw_claims:
    input:
        claims=first(rules.check_claims.output.claims),
    output:
        figure("claims", "Verdicts"),
    log:
        first(stage("draw_claims", "log.txt")),
    priority: LAST
    params:
        code=code("draw_claims.py"),
    script:
        "../scripts/draw_claims.py"


if SYNTHETIC:

    rule draw_forecasts:
        input:
            scores=first(rules.score_forecasts.output.scores),
            calibration=first(rules.score_forecasts.output.calibration),
        output:
            *figure("scores", "Evaluation", caption="forecast_scores"),
            *figure("calibration", "Evaluation"),
            *figure("pit", "Evaluation"),
        log:
            first(stage("draw_forecasts", "log.txt")),
        priority: LAST
        params:
            code=code("draw_forecasts.py"),
        script:
            "../scripts/draw_forecasts.py"

else:

    rule draw_scores:
        input:
            scores=first(rules.cross_validate.output.scores),
            summary=first(rules.cross_validate.output.summary),
        output:
            figure("scores", "Evaluation"),
        log:
            first(stage("draw_scores", "log.txt")),
        priority: LAST
        params:
            code=code("draw_scores.py"),
        script:
            "../scripts/draw_scores.py"


rule draw_fig11:
    input:
        trials=first(rules.simulate_trials.output.trials).replace(
            "{scenario}", SCENARIOS[0]
        ),
        description=first(rules.compare_models.output.description).replace(
            "{scenario}", SCENARIOS[0]
        ),
        comparisons=first(rules.compare_models.output.comparisons).replace(
            "{scenario}", SCENARIOS[0]
        ),
        paper=PAPER,
    output:
        figure("fig11", "Evaluation"),
    log:
        first(stage("draw_fig11", "log.txt")),
    priority: LAST
    params:
        code=code("draw_errors.py"),
        scenario=SCENARIOS[0],
        position=0,
        name="fig11",
    script:
        "../scripts/draw_errors.py"


rule draw_fig12:
    input:
        trials=first(rules.simulate_trials.output.trials).replace(
            "{scenario}", SCENARIOS[1]
        ),
        description=first(rules.compare_models.output.description).replace(
            "{scenario}", SCENARIOS[1]
        ),
        comparisons=first(rules.compare_models.output.comparisons).replace(
            "{scenario}", SCENARIOS[1]
        ),
        paper=PAPER,
    output:
        figure("fig12", "Evaluation"),
    log:
        first(stage("draw_fig12", "log.txt")),
    priority: LAST
    params:
        code=code("draw_errors.py"),
        scenario=SCENARIOS[1],
        position=1,
        name="fig12",
    script:
        "../scripts/draw_errors.py"
