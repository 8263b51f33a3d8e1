"""What the report tells, in the order of the paper: its sections, and which figures, tables and claims belong to each.

A figure is declared where it is drawn (``figure(name, category, caption)`` in ``workflow/rules/``). Its category puts it into a
section; one that no section names ends up under "More". What a run did not make is left out.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Section:
    """One section of the report.

    Attributes
    ----------
    key : name of its text, ``assets/text/<key>.html``
    title : heading
    figures : figures in their order; those of ``categories`` follow
    categories : categories of figures that belong here
    tables : names of tables, or beginnings of names that end in ``_`` (one table per scenario)
    interactive : what can be played with here: ``maps``, ``walks`` or nothing
    """

    key: str
    title: str
    figures: tuple[str, ...] = ()
    categories: tuple[str, ...] = ()
    tables: tuple[str, ...] = ()
    interactive: str = ""


SECTIONS = (
    Section("question", "The question"),
    Section("capture", "Capture", ("fig03", "fig04"), ("Setting", "Capture"), ("capture", "rejections", "classes", "realism")),
    Section("maps", "Suitability maps", ("fig05",)),
    Section("space", "Blending space", ("fig06", "dependency_clouds"), (), ("density",)),
    Section("model", "Run-time model", ("fig08", "fig09"), ("Model",), ("optimum",), interactive="maps"),
    Section("scenarios", "Both scenarios", ("fig10",), (), ("floor_",), interactive="walks"),
    Section("statistics", "Statistics", ("fig11", "fig12"), (), ("description_", "percentiles_", "comparisons_", "mixed_")),
    Section(
        "analyses",
        "Analyses",
        ("fig13", "fig14"),
        (),
        ("ablations", "ablations_calibrated", "leave_out", "neighbours", "neighbours_calibrated", "timings"),
    ),
    Section(
        "long_distance",
        "Long distances",
        ("fig15",),
        ("Analyses",),
        ("long_distance", "long_distance_optimum", "long_distance_sharpness", "saving"),
    ),
    Section("verdicts", "Verdicts", ("claims",), ("Verdicts",), ("claims", "verdicts")),
    Section(
        "forecasts",
        "Forecasts and calibration",
        ("scores", "calibration", "pit"),
        ("Evaluation",),
        ("scores", "calibration", "sharpness", "tests", "summary"),
    ),
    Section("more", "More results"),
    Section("inconsistencies", "Inconsistencies of the paper", tables=("inconsistencies",)),
    Section("assumptions", "Assumptions", tables=("assumptions",)),
    Section("record", "How this run was made"),
)

# Claims beside a figure: the beginning of their ids. All of them stand in the table of verdicts.
FIGURE_CLAIMS: dict[str, tuple[str, ...]] = {
    "fig08": ("sample_ms",),
    "fig11": ("scenario_1_", "wilcoxon_p_scenario_1_", "wilcoxon_power_scenario_1_", "median_reduction_scenario_1_", "normality"),
    "fig12": (
        "scenario_2_",
        "wilcoxon_p_scenario_2_",
        "wilcoxon_power_scenario_2_",
        "median_reduction_scenario_2_",
        "relative_delta_constant",
    ),
    "fig13": ("ablation_", "curvature_matters_most", "every_parameter_helps"),
    "fig14": ("k_sweep_", "interpolation_ms_", "k_above_50_suffices"),
    "fig15": ("long_distance_", "long_median_within_5_percent", "long_iqr_reproduced"),
}
# Claims beside a table.
TABLE_CLAIMS: dict[str, tuple[str, ...]] = {
    "optimum": ("p_stat_optimum_",),
    "leave_out": ("knn_leave_", "rbf_leave_"),
    "saving": ("application",),
}


def placed(found: dict[str, str]) -> dict[str, list[str]]:
    """Section key -> its figures, of the figures that a run has.

    Parameters
    ----------
    found : name of a figure -> its category
    """
    named = {name for section in SECTIONS for name in section.figures}
    at = {category: section.key for section in SECTIONS for category in section.categories}
    result: dict[str, list[str]] = {section.key: [name for name in section.figures if name in found] for section in SECTIONS}
    for name, category in found.items():
        if name not in named:
            result[at.get(category, "more")].append(name)
    return result


def tables_of(section: Section, found: list[str]) -> list[str]:
    """The section's tables, of those that a run has; the last resort has those that no section names."""
    if section.key == "more":
        return [name for name in found if not any(_wants(other, name) for other in SECTIONS)]
    return [name for wanted in section.tables for name in found if _matches(wanted, name)]


def _wants(section: Section, name: str) -> bool:
    return any(_matches(wanted, name) for wanted in section.tables)


def _matches(wanted: str, name: str) -> bool:
    return name == wanted or (wanted.endswith("_") and name.startswith(wanted))


def figure_title(name: str) -> str:
    """``fig03`` as Figure 3, any other figure by its name."""
    return f"Figure {int(name[3:])}" if name.startswith("fig") and name[3:].isdigit() else name.replace("_", " ").capitalize()
