"""The study under other choices and constants: make multiverse."""

from dataclasses import asdict

from walklab.multiverse.budget import Walked, affordable
from walklab.multiverse.choices import Choices
from walklab.multiverse.specifications import specifications
from walklab.randomness import generator

# The paper's study has the short name that its readers look for.
MULTIVERSE = (
    "results/multiverse" if CONFIG["run"] == "steering" else f"{RUN}/multiverse"
)
MULTIVERSE_PRODUCTS = [
    f"{MULTIVERSE}/claims.csv",
    f"{MULTIVERSE}/specifications.csv",
    f"{MULTIVERSE}/summary.csv",
    f"{MULTIVERSE}/figures/specification_curve.svg",
]
# How the configuration reads what the paper leaves open.
BASELINE = {
    "normalisation": CONFIG["blending_space"]["normalisation"],
    "weights": CONFIG["model"]["weights"],
    "scaling": CONFIG["blending_space"]["scaling"],
    "index": CONFIG["dependencies"]["index"],
    "curvature": CONFIG["dependencies"]["curvature"],
    "interpolation": CONFIG["model"][
        "kernel" if CONFIG["model"]["basis"] == "rbf" else "basis"
    ],
    "held": CONFIG["ablate_parameters"]["fixed"],
    "metric": CONFIG["metric"],
    **{
        name: CONFIG["planner"]["options"].get(name, default)
        for name, default in (
            ("turn_law", "proportional"),
            ("braking", True),
            ("ends_at", "line"),
        )
    },
}


def named_specifications():
    """Names of all specifications; their settings are in the table that list_specifications writes."""
    choices = CONFIG["multiverse"]
    rng = generator(CONFIG["seed"], "multiverse")
    try:
        found = specifications(
            Choices(**BASELINE), choices["combinations"], rng, choices["vary"]
        )
    except InputError as error:
        raise WorkflowError(f"{error}") from None
    return [one.name for one in found]


SPECIFICATIONS = named_specifications()


def study_size():
    """What is walked in the study."""
    training, scenario = CONFIG["record_training"], CONFIG["record_scenario"]
    return Walked(
        people=CONFIG["participants"]["training"]["count"],
        straight=len(training["straight_distances_m"]),
        turning=len(TURNS) * len(training["turning_distances_m"]),
        straight_repetitions=training["straight_repetitions"],
        turning_repetitions=training["turning_repetitions"],
        training_flawed=training["flawed_walks"],
        sets=tuple(scenario["sets"]),
        walks_per_set=walks_per_set(),
        scenario_flawed=scenario["flawed_walks"],
    )


SIZE = affordable(
    CONFIG["multiverse"]["budget_minutes"], len(SPECIFICATIONS), study_size()
)
CAPTURE = {
    **section(
        "seed",
        "participants",
        "generator",
        "scenarios",
        "standing",
        "extract_walks",
        "dependencies",
    ),
    "record_training": {
        **CONFIG["record_training"],
        "straight_repetitions": SIZE.walked.straight_repetitions,
        "turning_repetitions": SIZE.walked.turning_repetitions,
        "flawed_walks": SIZE.walked.training_flawed,
    },
    "record_scenario": {
        **CONFIG["record_scenario"],
        "sets": list(SIZE.walked.sets),
        "flawed_walks": SIZE.walked.scenario_flawed,
    },
}
POPULATION = ["training", *SCENARIOS]


wildcard_constraints:
    specification=r"[\w-]+",


rule multiverse:
    input:
        MULTIVERSE_PRODUCTS,
        f"{MULTIVERSE}/run.json",


rule list_specifications:
    output:
        specifications=f"{MULTIVERSE}/list_specifications/specifications.parquet",
    log:
        f"{MULTIVERSE}/list_specifications/log.txt",
    params:
        **section("seed", "multiverse"),
        baseline=BASELINE,
        study=asdict(study_size()),
        code=code("list_specifications.py"),
    script:
        "../scripts/list_specifications.py"


rule record_population:
    input:
        training_plans=TURN_PLANS,
        scenario_plans=list(CONFIG["scenarios"].values()),
    output:
        walks=expand(
            f"{MULTIVERSE}/record_population/{{part}}/walks.parquet", part=POPULATION
        ),
        samples=expand(
            f"{MULTIVERSE}/record_population/{{part}}/samples.parquet", part=POPULATION
        ),
    log:
        f"{MULTIVERSE}/record_population/log.txt",
    params:
        **CAPTURE,
        code=code("record_population.py"),
    script:
        "../scripts/record_population.py"


rule evaluate_specification:
    input:
        specifications=rules.list_specifications.output.specifications,
        walks=rules.record_population.output.walks,
        samples=rules.record_population.output.samples,
        training_plans=rules.record_population.input.training_plans,
        scenario_plans=rules.record_population.input.scenario_plans,
        paper=PAPER,
    output:
        claims=f"{MULTIVERSE}/evaluate_specification/{{specification}}/claims.parquet",
        outcome=f"{MULTIVERSE}/evaluate_specification/{{specification}}/outcome.json",
    log:
        f"{MULTIVERSE}/evaluate_specification/{{specification}}/log.txt",
    params:
        **CAPTURE,
        **section(
            "planner",
            "body",
            "space",
            "blending_space",
            "fit_static",
            "model",
            "calibrate_model",
            "statistics",
            "multiverse",
        ),
        code=code("evaluate_specification.py"),
    script:
        "../scripts/evaluate_specification.py"


rule collect_specifications:
    input:
        specifications=rules.list_specifications.output.specifications,
        claims=expand(
            rules.evaluate_specification.output.claims, specification=SPECIFICATIONS
        ),
        outcomes=expand(
            rules.evaluate_specification.output.outcome, specification=SPECIFICATIONS
        ),
    output:
        claims=f"{MULTIVERSE}/claims.csv",
        specifications=f"{MULTIVERSE}/specifications.csv",
        summary=report(
            f"{MULTIVERSE}/summary.csv",
            caption="../report/table.rst",
            category="Tables",
        ),
    log:
        f"{MULTIVERSE}/collect_specifications/log.txt",
    params:
        code=code("collect_specifications.py"),
    script:
        "../scripts/collect_specifications.py"


rule draw_specification_curve:
    input:
        claims=rules.collect_specifications.output.claims,
        specifications=rules.collect_specifications.output.specifications,
    output:
        report(
            f"{MULTIVERSE}/figures/specification_curve.svg",
            caption="../report/specification_curve.rst",
            category="Multiverse",
        ),
        f"{MULTIVERSE}/figures/specification_curve.png",
    log:
        f"{MULTIVERSE}/draw_specification_curve/log.txt",
    params:
        scenarios=SCENARIOS,
        code=code("draw_specification_curve.py"),
    script:
        "../scripts/draw_specification_curve.py"
