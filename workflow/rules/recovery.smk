"""Self-consistency: does the method recover a distribution that is known? Walks made by the planner itself; nobody walked them."""


rule recover_distribution:
    input:
        plans=rules.record_training.input.plans,
    output:
        recovery=report(
            f"{RUN}/recovery.csv", caption="../report/table.rst", category="Tables"
        ),
        densities=first(stage("recover_distribution", "densities.csv")),
    log:
        first(stage("recover_distribution", "log.txt")),
    params:
        **TRIALS,
        **section(
            "body",
            "record_training",
            "blending_space",
            "model",
            "recover_distribution",
        ),
        code=code("recover_distribution.py"),
    script:
        "../scripts/recover_distribution.py"


rule draw_recovery:
    input:
        recovery=rules.recover_distribution.output.recovery,
        densities=rules.recover_distribution.output.densities,
    output:
        figure("recovery", "Self-consistency"),
    log:
        first(stage("draw_recovery", "log.txt")),
    params:
        code=code("draw_recovery.py"),
    script:
        "../scripts/draw_recovery.py"
