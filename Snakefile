"""walklab: what captured human walks tell about steering, from capture to the verdict on a paper's claims."""


configfile: "config/config.yaml"


include: "workflow/rules/common.smk"
include: "workflow/rules/capture.smk"
include: "workflow/rules/steering.smk"
include: "workflow/rules/evaluation.smk"
include: "workflow/rules/forecasts.smk"
include: "workflow/rules/verdicts.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/replicates.smk"
include: "workflow/rules/recovery.smk"
include: "workflow/rules/multiverse.smk"
include: "workflow/rules/record.smk"
include: "workflow/rules/report.smk"


report: "workflow/report/workflow.rst"


rule all:
    default_target: True
    input:
        PRODUCTS,
        f"{RUN}/run.json",
        REPORT,


rule recovery:
    input:
        rules.recover_distribution.output.recovery,
        rules.draw_recovery.output,
        f"{RUN}/run.json" if RECOVERED else [],
