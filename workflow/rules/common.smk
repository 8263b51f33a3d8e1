"""What every rule shares: configuration, wildcards, code digests, names of files."""

import os
import sys
from pathlib import Path

import yaml
from snakemake.exceptions import WorkflowError
from snakemake.utils import update_config

from walklab import code_digest, job_environment
from walklab.capture.recording_files import present
from walklab.configuration import check_path, complete, load_schema, named_paths
from walklab.consistency import require_consistent
from walklab.errors import InputError
from walklab.estimate import estimate
from walklab.geometry.plans import load_plan

# The checkout, also when the workflow is a module of another one.
ROOT = Path(workflow.current_basedir.get_path_or_uri(secret_free=True)).parents[1]
if not ROOT.is_dir():
    raise WorkflowError(
        f"{ROOT}: walklab needs a local checkout; clone it and name its Snakefile"
    )
job_environment.prepare(ROOT)


def completed(config):
    """The configuration over that of the paper, with all defaults, or one message."""
    whole = yaml.safe_load((ROOT / "config/config.yaml").read_text())
    update_config(whole, config)
    try:
        whole = complete(
            whole, load_schema(ROOT / "workflow/schemas/config.schema.yaml")
        )
        require_consistent(whole)
        return whole
    except InputError as error:
        raise WorkflowError(f"{error}") from None


def shipped(path):
    """A file that comes with walklab: as it is named, or in the checkout when another workflow uses walklab."""
    elsewhere = not Path(path).exists() and (ROOT / path).exists()
    return str(ROOT / path) if elsewhere else path


def check_files(config):
    """Stop before anything runs if a file that the configuration names is not there, or is none of its business."""
    allowed = [Path.cwd(), ROOT, os.environ["WALKLAB_DATA"]]
    if config["allow_outside_paths"]:
        allowed = ["/"]
    try:
        for key, path in named_paths(config).items():
            check_path(key, path, allowed)
    except InputError as error:
        raise WorkflowError(f"{error}") from None


def check_writable():
    """Stop before the first job if nothing can be written."""
    folder = next(path for path in (Path(RUN), *Path(RUN).parents) if path.exists())
    if not os.access(folder, os.W_OK):
        raise WorkflowError(
            f"{folder} is read-only; make it writable, or work in another folder (snakemake --directory)"
        )


CONFIG = completed(config)
CONFIG["scenarios"] = {
    name: shipped(path) for name, path in CONFIG["scenarios"].items()
}
check_files(CONFIG)
config.update(CONFIG)  # what the report's text sees
RUN = f"results/{CONFIG['run']}"
PAPER = shipped("config/papers/agethen_steering.yaml")
# Several populations: claims and scores over all of them instead of the figures of one. They are numbered from 1: population
# 0 is that of the single study, on which models were designed, so it can judge none of them.
REPLICATED = CONFIG["replicates"] > 1
REPLICATES = range(1, CONFIG["replicates"] + 1) if REPLICATED else [0]
# A run of this name is that study alone (config/recovery.yaml).
RECOVERED = CONFIG["run"] == "recovery"
SHARDS = range(CONFIG["shards"])
SCENARIOS = list(CONFIG["scenarios"])
# The priority of figures. Nothing but the report waits for them, and jobs that short keep every core busy to the end.
LAST = -1


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
    """A product of the first population, which figures and tables show; what is made of all of them lies there too."""
    return path.replace("{replicate}", str(REPLICATES[0]))


def bulky(path):
    """A file that is read once; of many populations it is deleted after that, since all together would fill a disk."""
    return temp(path) if REPLICATED else path


def assumption_sources():
    """Every file that may state an assumption."""
    folders = ("src/walklab", "workflow", "config")
    return sorted(
        os.path.relpath(path)
        for folder in folders
        for path in (ROOT / folder).rglob("*")
        if path.suffix in {".py", ".smk", ".yaml"}
    )


def report_assets():
    """Templates, style and script of the report: not Python, so code() does not see them."""
    assets = (ROOT / "src/walklab/report/assets").rglob("*.*")
    return sorted(os.path.relpath(path) for path in assets)


def walks_per_set():
    """Walks in one set of all scenarios together."""
    return sum(
        len(load_plan(ROOT / path).walks) for path in CONFIG["scenarios"].values()
    )


def announce():
    """One paragraph before the run: what it computes, about how long and how much disk it takes."""
    return f"walklab {CONFIG['run']}: {estimate(CONFIG, walks_per_set(), workflow.cores)} in {RUN}/."


def source_files(wildcards):
    """The files of real or own walks."""
    path = Path(os.path.expandvars(CONFIG["source"]["path"] or ""))
    return sorted(map(str, path.rglob("*.a[sm][fc]"))) if path.is_dir() else str(path)


def recordings(wildcards):
    """The recordings of real people that are there; none is needed."""
    return list(map(str, present(os.path.expandvars("$WALKLAB_DATA"))))


# Stands beside every figure and table of a report whose walks are not what a reader would expect.
WALKED = (
    {"walks": "resampled from recordings"}
    if CONFIG["source"]["kind"] == "resampled"
    else {}
)


# Every declared figure: name -> category, drawing and caption; what build_report shows.
FIGURES = {}


def figure(name, category, caption=None):
    """A figure as SVG, which the report shows, and PNG. The category decides on its section (walklab.report.sections)."""
    FIGURES[name] = {
        "category": category,
        "drawing": f"{RUN}/figures/{name}.svg",
        "caption": os.path.relpath(ROOT / f"workflow/report/{caption or name}.rst"),
    }
    caption = f"../report/{caption or name}.rst"
    shown = report(
        f"{RUN}/figures/{name}.svg",
        caption=caption,
        category=category,
        labels={"figure": name, **WALKED},
    )
    return [shown, f"{RUN}/figures/{name}.png"]


def page(name):
    """A table's page in the report."""
    path = f"{RUN}/tables/{name}.html"
    return report(
        path,
        caption="../report/table.rst",
        category="Tables",
        labels={"table": TABLE_TITLES[name], **WALKED},
    )
