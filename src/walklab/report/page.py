"""The report as one HTML page that needs nothing but itself.

Every value goes through jinja2's escaping: names and texts of a run are data, never markup. A content security policy lets
the page run its own script and style, known by their digests, and fetch nothing.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any

import jinja2
import yaml
from markupsafe import Markup

from walklab.figures.claims import VERDICTS
from walklab.figures.pages import number_text
from walklab.figures.style import MODEL_COLOURS, OTHER_MODEL, read_name
from walklab.report.contents import Contents
from walklab.report.findings import forecast_findings, real_findings, realism_findings
from walklab.report.published import Comparison, beside_figure, beside_table, claimed, published_text
from walklab.report.sections import SECTIONS, Section, figure_title, placed, tables_of
from walklab.report.tables import Table, headline, table_of, verdict_counts, with_interval

STYLES = ("style.css", "widgets.css", "print.css")
SCRIPTS = ("theme.js", "tables.js", "drawing.js", "maps.js", "walks.js")
ALWAYS = {"question", "record"}  # sections that every run has
LONG_TABLE = 12  # rows; a longer or wider table is folded away until it is asked for
WIDE_TABLE = 10  # columns
LONGEST_TABLE = 300  # rows; nobody reads more, and its file is named


@cache
def asset(name: str) -> str:
    """A file that ships with the report."""
    return (files("walklab.report") / "assets" / name).read_text()


def environment() -> jinja2.Environment:
    """Templates with escaping on and no silent blanks."""
    found = jinja2.Environment(
        loader=jinja2.FunctionLoader(asset),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    found.filters |= {
        "number": number_text,
        "interval": with_interval,
        "label": label,
        "model": read_name,
        "published": published_text,
    }
    return found


def label(name: str) -> Markup | str:
    """``P_Prob (calibrated)`` with its index set low."""
    head, _, rest = name.partition(" ")
    base, _, index = head.partition("_")
    if base != "P" or not index:
        return name.replace("_", " ")
    return Markup("P<sub>{}</sub>{}").format(index, f" {rest}" if rest else "")


def render(contents: Contents) -> str:
    """The page."""
    style = "\n".join(asset(name) for name in STYLES)
    script = "\n".join(asset(name) for name in SCRIPTS)
    allowed = f"img-src data:; style-src {_digest(style)}; script-src {_digest(script)}"
    policy = f"default-src 'none'; {allowed}; base-uri 'none'; form-action 'none'"
    frames, kind = contents.frames, contents.record["config"]["source"]["kind"]
    return (
        environment()
        .get_template("report.html")
        .render(
            policy=policy,
            style=Markup(style),
            script=Markup(script),
            record=contents.record,
            configuration=yaml.safe_dump(dict(contents.record["config"]), sort_keys=False, allow_unicode=True),
            synthetic=kind in ("synthetic", "resampled"),
            resampled=kind == "resampled",
            paper=contents.paper,
            sections=[found for section in SECTIONS if (found := _section(section, contents))["present"]],
            present=set(frames) | set(contents.figures),
            medians=headline(contents),
            verdicts=verdict_counts(frames.get("claims"), list(VERDICTS)),
            forecast_findings=forecast_findings(frames.get("scores"), frames.get("tests")) + real_findings(frames.get("tests")),
            realism_findings=realism_findings(frames.get("realism")),
            marks=VERDICT_MARKS,
            long_table=LONG_TABLE,
            wide_table=WIDE_TABLE,
            longest_table=LONGEST_TABLE,
            data={
                "maps": contents.maps,
                "scenes": contents.scenes,
                "colours": {**MODEL_COLOURS, "": OTHER_MODEL},
            },
        )
    )


# Shape and word, so that a verdict can be told without colour; the shapes are those of the figure of claims.
VERDICT_MARKS = {"reproduced": "●", "partly": "▲", "not reproduced": "✕", "not checkable": "■"}


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _section(section: Section, contents: Contents) -> dict[str, Any]:
    """A section with what the run has of it."""
    frames, config = contents.frames, contents.record["config"]
    shown = placed({name: figure.category for name, figure in contents.figures.items()})[section.key]
    figures = [
        {
            "figure": contents.figures[name],
            "title": figure_title(name),
            "comparisons": beside_figure(name, contents.paper, frames, config) if contents.paper else [],
        }
        for name in shown
    ]
    tables = [_table(name, contents) for name in tables_of(section, list(contents.tables))]
    interactive = {"maps": contents.maps, "walks": contents.scenes}.get(section.interactive)
    return {
        "key": section.key,
        "title": section.title,
        "interactive": section.interactive,
        "figures": figures,
        "tables": tables,
        "all_claims": claimed(frames.get("claims"), ("",)) if section.key == "verdicts" else [],
        "present": bool(section.key in ALWAYS or figures or tables or interactive),
    }


def _table(name: str, contents: Contents) -> Mapping[str, Any]:
    found = contents.tables[name]
    table: Table = table_of(found.frame, name, found.title, found.file)
    comparisons: list[Comparison] = beside_table(name, contents.frames)
    return {"table": table, "comparisons": comparisons}
