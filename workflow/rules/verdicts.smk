"""Claims, assumptions and the record of the run."""

# Over many populations the ablations are left out, and with them the claims that need them.
ABLATIONS = (
    {} if REPLICATED else {"ablations": rules.ablate_parameters.output.ablations}
)


rule check_claims:
    input:
        **ABLATIONS,
        **{
            table: expand(
                rules.compare_models.output[table],
                scenario=SCENARIOS,
                allow_missing=True,
            )
            for table in ("description", "percentiles", "reductions", "comparisons")
        },
        paper=PAPER,
        optimum=rules.fit_static.output.optimum,
        leave_one_out=rules.leave_out.output.summary,
        neighbours=rules.sweep_neighbours.output.errors,
        neighbour_timings=rules.sweep_neighbours.output.timings,
        long_distance=rules.simulate_long_distance.output.table,
        production=rules.estimate_saving.output.saving,
    output:
        claims=stage("check_claims", "claims.csv"),
    log:
        stage("check_claims", "log.txt"),
    params:
        **section("scenarios"),
        code=code("check_claims.py"),
    script:
        "../scripts/check_claims.py"


rule compare_verdicts:
    input:
        claims=first(rules.check_claims.output.claims),
        other=CONFIG["compare_verdicts"]["other"] or [],
    output:
        verdicts=report(
            f"{RUN}/verdicts.csv",
            caption="../report/table.rst",
            category="Verdicts",
        ),
    log:
        first(stage("compare_verdicts", "log.txt")),
    params:
        code=code("compare_verdicts.py"),
    script:
        "../scripts/compare_verdicts.py"


rule list_assumptions:
    input:
        paper=PAPER,
        sources=assumption_sources(),
    output:
        assumptions=f"{RUN}/tables/assumptions.csv",
        inconsistencies=f"{RUN}/tables/inconsistencies.csv",
    log:
        first(stage("list_assumptions", "log.txt")),
    params:
        code=code("list_assumptions.py"),
        root=os.path.relpath(ROOT),
    script:
        "../scripts/list_assumptions.py"


# Tables of the report: name -> (file, title).
_TABLES = {
    "claims": (
        first(rules.check_claims.output.claims),
        "Claims of the paper and our verdicts",
    ),
    "capture": (first(rules.summarise_capture.output.summary), "Captured walks"),
    "rejections": (
        first(rules.summarise_capture.output.rejections),
        "Movements left out, by reason",
    ),
    "optimum": (
        first(rules.fit_static.output.optimum),
        "P_Stat: the optimum of simulated annealing",
    ),
    "density": (
        first(rules.build_space.output.density),
        "Density of the blending space before and after up-sampling",
    ),
    **{
        f"{table}_{scenario}": (
            first(rules.compare_models.output[table]).replace("{scenario}", scenario),
            title,
        )
        for scenario in SCENARIOS
        for words in [scenario.replace("_", " ")]
        for table, title in (
            ("description", f"Travel-time errors, {words}"),
            (
                "percentiles",
                f"Percentiles of the travel-time errors and their intervals, {words}",
            ),
            (
                "description_by_hull",
                f"Travel-time errors inside and outside the training dependencies, {words}",
            ),
            ("comparisons", f"Pairs of models, {words}"),
            (
                "mixed",
                f"Mixed models with a random intercept per participant, {words}",
            ),
        )
    },
    **{
        f"floor_{scenario}": (
            first(rules.floor_grid.output.floor).replace("{scenario}", scenario),
            f"Error floor of the grid: each walk with the best cell of its own map, {words}",
        )
        for scenario in SCENARIOS
        for words in [scenario.replace("_", " ")]
    },
    "scores": (
        first(rules.score_forecasts.output.scores),
        "Proper scores of all forecasts (P_Stat and P_Adapt with residual spread), split by the training range",
    ),
    "sharpness": (
        first(rules.calibrate_model.output.candidates),
        "Sharpness learned from training walks: every candidate",
    ),
    "tests": (
        first(rules.compare_forecasts.output.tests),
        "Pairs of forecasts: tests that know who walked",
    ),
    "ablations": (first(rules.ablate_parameters.output.ablations), "Ablations"),
    "ablations_calibrated": (
        first(rules.ablate_parameters.output.calibrated),
        "Ablations of P_Prob (calibrated), beyond the paper",
    ),
    "leave_out": (first(rules.leave_out.output.summary), "Leave-one-out checks"),
    "neighbours": (
        first(rules.sweep_neighbours.output.errors),
        "Errors by number of neighbours",
    ),
    "neighbours_calibrated": (
        first(rules.sweep_neighbours.output.calibrated),
        "Errors of P_Prob (calibrated) by number of neighbours, beyond the paper",
    ),
    "timings": (
        first(rules.sweep_neighbours.output.timings),
        "Time by number of neighbours (measured in this run)",
    ),
    "long_distance": (
        first(rules.simulate_long_distance.output.table),
        "Long distances",
    ),
    "long_distance_optimum": (
        first(rules.simulate_long_distance.output.optimum),
        "Long distances: P_Stat",
    ),
    "long_distance_sharpness": (
        first(rules.simulate_long_distance.output.sharpness),
        "Long distances: the exponent of P_Prob (calibrated), learned from the training walks",
    ),
    "saving": (
        first(rules.estimate_saving.output.saving),
        "The production example of 7.5",
    ),
    "inconsistencies": (
        f"{RUN}/tables/inconsistencies.csv",
        "Inconsistencies of the paper and our readings",
    ),
    "assumptions": (
        f"{RUN}/tables/assumptions.csv",
        "Assumptions where the paper is silent",
    ),
}
if not RESAMPLED:
    _TABLES["realism"] = (
        f"{RUN}/realism.csv",
        "How real the synthetic capture is: its walks beside recorded ones",
    )
if CONFIG["compare_verdicts"]["other"]:
    _TABLES["verdicts"] = (
        f"{RUN}/verdicts.csv",
        f"Verdicts of this run beside those of {CONFIG['compare_verdicts']['other']}",
    )
TABLES = {name: file for name, (file, _) in _TABLES.items()}
TABLE_TITLES = {name: title for name, (_, title) in _TABLES.items()}


rule render_tables:
    input:
        tables=list(TABLES.values()),
    output:
        pages=[page(name) for name in TABLES],
    log:
        first(stage("render_tables", "log.txt")),
    params:
        code=code("render_tables.py"),
        titles=list(TABLE_TITLES.values()),
    script:
        "../scripts/render_tables.py"
