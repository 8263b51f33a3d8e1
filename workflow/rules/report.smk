"""The report worth sending: one page and one PDF, of whatever the run has made."""

RESULTS = STEERING if SYNTHETIC else REAL
# Tables of the page, name -> (file, title): those with a page of their own, and every table of results.
REPORT_TABLES = {
    **{
        Path(file).stem: (file, Path(file).stem.replace("_", " ").capitalize())
        for file in RESULTS
        if file.endswith(".csv")
    },
    **(
        {name: (file, TABLE_TITLES[name]) for name, file in TABLES.items()}
        if SYNTHETIC
        else {}
    ),
    **(
        {"classes": (first(rules.count_distances.output.classes), "Planned distances")}
        if SYNTHETIC
        else {}
    ),
}
_SCENES = {
    "walks": SCENARIO_FILES["walks"],
    "samples": SCENARIO_FILES["samples"],
    "routes": SCENARIO_FILES["routes"],
    "trials": expand(first(rules.simulate_trials.output.trials), scenario=SCENARIOS),
    "plans": list(CONFIG["scenarios"].values()),
    "calibration": first(rules.calibrate_model.output.calibration),
    "paper": PAPER,
}


def shown_figures():
    """The declared figures that this run makes: name, category, drawing and caption of each."""
    return {
        name: about for name, about in FIGURES.items() if about["drawing"] in RESULTS
    }


rule build_report:
    input:
        **(_SCENES if SYNTHETIC else {}),
        products=RESULTS,
        model=first(rules.train_model.output.model),
        tables=[file for file, _ in REPORT_TABLES.values()],
        captions=[about["caption"] for about in shown_figures().values()],
        assets=report_assets(),
    output:
        page=f"{RUN}/report.html",
        pdf=f"{RUN}/report.pdf",
    log:
        first(stage("build_report", "log.txt")),
    params:
        **RECORDING,
        **section("seed", "planner", "space", "scenarios"),
        folder=RUN,
        tables=REPORT_TABLES,
        figures=shown_figures(),
        code=code("build_report.py"),
    script:
        "../scripts/build_report.py"
