"""What every rule shares: configuration, wildcards, code digests, names of files."""

import os
import sys
from pathlib import Path

from snakemake.exceptions import WorkflowError

from walklab import code_digest, job_environment
from walklab.configuration import complete, load_schema
from walklab.consistency import require_consistent
from walklab.errors import InputError
from walklab.estimate import estimate
from walklab.geometry.plans import load_plan

ROOT = Path(workflow.basedir)
job_environment.prepare(ROOT)


def completed(config):
    """The configuration with all defaults, or one message."""
    try:
        whole = complete(
            config, load_schema(ROOT / "workflow/schemas/config.schema.yaml")
        )
        require_consistent(whole)
        return whole
    except InputError as error:
        raise WorkflowError(f"{error}") from None


def check_files(config):
    """Stop before anything runs if a file that the configuration names is not there."""
    named = {f"scenarios.{name}": path for name, path in config["scenarios"].items()}
    if config["source"]["kind"] != "synthetic":
        named["source.path"] = os.path.expandvars(config["source"]["path"] or "")
        named |= {
            f"source.plans.{index}": path
            for index, path in enumerate(config["source"]["plans"])
        }
    for key, path in named.items():
        if not Path(path).exists():
            raise WorkflowError(
                f"config key {key}: {path or 'null'} does not exist; correct the path (or set WALKLAB_DATA)"
            )


CONFIG = completed(config)
check_files(CONFIG)
config.update(CONFIG)  # what the report's text sees
RUN = f"results/{CONFIG['run']}"
REPLICATES = range(CONFIG["replicates"])
SHARDS = range(CONFIG["shards"])
SCENARIOS = list(CONFIG["scenarios"])


wildcard_constraints:
    replicate=r"\d+",
    shard=r"\d+",
    scenario="|".join(SCENARIOS),


CODE = {}  # digests by script, for the record of the run


def code(script):
    """Digest of a rule's script and all it computes with; see walklab.code_digest."""
    CODE[script] = code_digest.digest(
        ROOT / "workflow/scripts" / script, ROOT / "src/walklab"
    )
    return CODE[script]


def section(*names):
    """The named sections of the configuration, as the parameters of a rule."""
    return {name: CONFIG[name] for name in names}


def stage(name, file, *wildcards):
    """Path of a stage's product: results/<run>/<replicate>/<stage>/[wildcards/]<file>."""
    parts = "".join(f"{{{wildcard}}}/" for wildcard in wildcards)
    return f"{RUN}/{{replicate}}/{name}/{parts}{file}"


def first(path):
    """A product of replicate 0, which figures and tables show."""
    return path.replace("{replicate}", "0")


def assumption_sources():
    """Every file that may state an assumption."""
    folders = ("src/walklab", "workflow", "config")
    return sorted(
        str(path.relative_to(ROOT))
        for folder in folders
        for path in (ROOT / folder).rglob("*")
        if path.suffix in {".py", ".smk", ".yaml"}
    )


def announce():
    """One paragraph before the run: what it computes, about how long and how much disk it takes."""
    walks_per_set = sum(
        len(load_plan(ROOT / path).walks) for path in CONFIG["scenarios"].values()
    )
    return f"walklab {CONFIG['run']}: {estimate(CONFIG, walks_per_set, workflow.cores)} in {RUN}/."


def source_files(wildcards):
    """The files of real or own walks."""
    path = Path(os.path.expandvars(CONFIG["source"]["path"] or ""))
    return sorted(map(str, path.rglob("*.a[sm][fc]"))) if path.is_dir() else str(path)


def figure(name, category, caption=None):
    """A figure as SVG, which the report shows, and PNG."""
    caption = f"../report/{caption or name}.rst"
    shown = report(
        f"{RUN}/figures/{name}.svg",
        caption=caption,
        category=category,
        labels={"figure": name},
    )
    return [shown, f"{RUN}/figures/{name}.png"]


def page(name):
    """A table's page in the report."""
    path = f"{RUN}/tables/{name}.html"
    return report(
        path,
        caption="../report/table.rst",
        category="Tables",
        labels={"table": TABLE_TITLES[name]},
    )


def benchmarks(wildcards, input):
    """Benchmark files of every job of this configuration; an earlier one may have left others."""
    parts = {str(number) for number in SHARDS} | set(SCENARIOS)
    found = [
        path
        for replicate in REPLICATES
        for path in Path(f"{RUN}/{replicate}").rglob("benchmark.tsv")
    ]
    return sorted(str(path) for path in found if set(path.parts[4:-1]) <= parts)
