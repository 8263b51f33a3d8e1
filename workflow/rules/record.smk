"""What a run consists of, what it will cost, and the record of what it was."""

# The paper's figures and tables, in its order.
STEERING = [
    *(
        f"{RUN}/figures/fig{number}.svg"
        for number in (
            "03",
            "04",
            "05",
            "06",
            "08",
            "09",
            "10",
            "11",
            "12",
            "13",
            "14",
            "15",
        )
    ),
    f"{RUN}/figures/dependency_clouds.svg",
    f"{RUN}/figures/claims.svg",
    f"{RUN}/model_card.md",
    f"{RUN}/claims.csv",
    f"{RUN}/scores.csv",
    f"{RUN}/calibration.csv",
    *(f"{RUN}/figures/{name}.svg" for name in ("scores", "calibration", "pit")),
    # A capture made of the recordings proves nothing by resembling them.
    *([] if RESAMPLED else [f"{RUN}/realism.csv", f"{RUN}/figures/realism.svg"]),
    *([f"{RUN}/verdicts.csv"] if CONFIG["compare_verdicts"]["other"] else []),
    *(f"{RUN}/tables/{name}.html" for name in TABLES),
]
# The study of many populations.
POPULATIONS = [
    f"{RUN}/claims.csv",
    f"{RUN}/scores.csv",
    f"{RUN}/figures/replicated_claims.svg",
    f"{RUN}/figures/replicated_scores.svg",
]
# Leave-one-subject-out on real or own walks.
REAL = [
    f"{RUN}/scores.csv",
    f"{RUN}/summary.csv",
    f"{RUN}/calibration.csv",
    f"{RUN}/tests.csv",
    f"{RUN}/figures/scores.svg",
    f"{RUN}/figures/fig05.svg",
    f"{RUN}/figures/fig06.svg",
    f"{RUN}/model_card.md",
]
# Self-consistency, by planner walks alone.
RECOVERY = [
    rules.recover_distribution.output.recovery,
    *rules.draw_recovery.output,
]
PRODUCTS = (POPULATIONS if REPLICATED else STEERING) if SYNTHETIC else REAL
PRODUCTS = RECOVERY if RECOVERED else PRODUCTS
# The page shows one population; many, or planner walks, have their tables and figures.
REPORTED = not (REPLICATED or RECOVERED)
REPORT = [f"{RUN}/report.html", f"{RUN}/report.pdf"] if REPORTED else []
# Folder -> what its record is of.
RECORDED = {RUN: PRODUCTS, MULTIVERSE: MULTIVERSE_PRODUCTS}


def costs(wildcards, input):
    """What every job of this configuration has left of its cost; an earlier one may have left others."""
    folder = wildcards.get("folder", RUN)
    roots = [f"{RUN}/{number}" for number in REPLICATES] if folder == RUN else [folder]
    parts = {*map(str, SHARDS), *SCENARIOS, *SPECIFICATIONS}
    return sorted(
        str(path)
        for root in roots
        for path in Path(root).rglob("cost.json")
        if set(path.relative_to(root).parts[1:-1]) <= parts
    )


# What a record is made of, beside the products; the report shows the same of its run, without its own last seconds.
RECORDING = {
    "config": CONFIG,
    "root": os.path.relpath(ROOT),
    "costs": costs,
    "digests": lambda wildcards: dict(CODE),
}


if SYNTHETIC and not REPLICATED:

    rule publish_scores:
        input:
            claims=first(rules.check_claims.output.claims),
            scores=first(rules.score_forecasts.output.scores),
            calibration=first(rules.score_forecasts.output.calibration),
        output:
            claims=f"{RUN}/claims.csv",
            scores=report(
                f"{RUN}/scores.csv", caption="../report/table.rst", category="Tables"
            ),
            calibration=f"{RUN}/calibration.csv",
        log:
            first(stage("publish_scores", "log.txt")),
        params:
            code=code("publish_scores.py"),
        script:
            "../scripts/publish_scores.py"

elif not SYNTHETIC:

    rule publish_scores:
        input:
            scores=first(rules.cross_validate.output.scores),
            summary=first(rules.cross_validate.output.summary),
            calibration=first(rules.cross_validate.output.calibration),
            tests=first(rules.compare_forecasts.output.tests),
        output:
            scores=report(
                f"{RUN}/scores.csv", caption="../report/table.rst", category="Tables"
            ),
            summary=report(
                f"{RUN}/summary.csv", caption="../report/table.rst", category="Tables"
            ),
            calibration=f"{RUN}/calibration.csv",
            tests=report(
                f"{RUN}/tests.csv", caption="../report/table.rst", category="Tables"
            ),
        log:
            first(stage("publish_scores", "log.txt")),
        params:
            code=code("publish_scores.py"),
        script:
            "../scripts/publish_scores.py"


rule describe_model:
    input:
        model=first(rules.train_model.output.model),
        scores=f"{RUN}/scores.csv" if SYNTHETIC else f"{RUN}/summary.csv",
    output:
        model=f"{RUN}/model.safetensors",
        card=f"{RUN}/model_card.md",
    log:
        first(stage("describe_model", "log.txt")),
    params:
        **section("run", "source"),
        code=code("describe_model.py"),
    script:
        "../scripts/describe_model.py"


rule record_run:
    input:
        # So that its cost is known.
        report=lambda wildcards: REPORT if wildcards.folder == RUN else [],
        products=lambda wildcards: RECORDED[wildcards.folder],
    output:
        record="{folder}/run.json",
    log:
        "{folder}/record_run/log.txt",
    wildcard_constraints:
        folder="|".join(RECORDED),
    params:
        **RECORDING,
        code=code("record_run.py"),
        folder=lambda wildcards: wildcards.folder,
    script:
        "../scripts/record_run.py"


onstart:
    check_writable()
    if told := job_environment.stale(ROOT):
        print(told, file=sys.stderr)
    # The estimate is that of the whole study.
    if not workflow.dag_settings.targets:
        print(announce())
    if "multiverse" in workflow.dag_settings.targets:
        print(f"walklab multiverse: {SIZE}; results in {MULTIVERSE}/.")


onsuccess:
    if not workflow.dag_settings.targets and REPORTED:
        print(f"The report is {RUN}/report.html.")
    folder = MULTIVERSE if "multiverse" in workflow.dag_settings.targets else RUN
    print(f"All results are in {folder}/.")
