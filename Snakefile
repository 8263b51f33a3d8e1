"""walklab: three studies of human walking, each from capture to the verdict on a paper's claims."""


configfile: "config/config.yaml"


include: "workflow/rules/common.smk"
include: "workflow/rules/capture.smk"
include: "workflow/rules/steering.smk"
