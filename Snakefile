"""walklab: what captured human walks tell about steering, from capture to the verdict on a paper's claims."""


configfile: "config/config.yaml"


include: "workflow/rules/common.smk"
include: "workflow/rules/capture.smk"
include: "workflow/rules/steering.smk"
include: "workflow/rules/evaluation.smk"
include: "workflow/rules/forecasts.smk"
include: "workflow/rules/verdicts.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/record.smk"
include: "workflow/rules/report.smk"


report: "workflow/report/workflow.rst"


rule all:
    default_target: True
    input:
        STEERING if SYNTHETIC else REAL,
        f"{RUN}/run.json",
        rules.build_report.output,
