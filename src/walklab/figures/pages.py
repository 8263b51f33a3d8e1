"""Tables as self-contained HTML pages for the report."""

from __future__ import annotations

from html import escape

import pandas as pd

from walklab.figures.claims import VERDICTS

LONG_TEXT = 40

STYLE = """
:root { color-scheme: light dark; font: 14px/1.45 system-ui, sans-serif; }
body { margin: 1.5rem; }
h1 { font-size: 1.2rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; }
th, td { padding: .3rem .6rem; text-align: left; vertical-align: top; border-bottom: 1px solid #8886; }
th { position: sticky; top: 0; background: Canvas; }
td.long { min-width: 22rem; }
td.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
"""


def _verdict_style() -> str:
    # The colours of the figure of claims, so that a verdict looks the same everywhere.
    return "".join(f"td.{name.replace(' ', '-')} {{ border-left: 4px solid {hue}; }}\n" for name, (_, hue) in VERDICTS.items())


def table_page(table: pd.DataFrame, title: str) -> str:
    """A page with one table: numbers to the right with four significant digits, verdicts marked by colour and word."""
    header = "".join(f"<th>{escape(str(name).replace('_', ' '))}</th>" for name in table.columns)
    rows = "\n".join(f"<tr>{''.join(_cell(name, row[name]) for name in table.columns)}</tr>" for _, row in table.iterrows())
    head = f'<meta charset="utf-8"><title>{escape(title)}</title><style>{STYLE}{_verdict_style()}</style>'
    body = f"<table><thead><tr>{header}</tr></thead>\n<tbody>\n{rows}\n</tbody></table>"
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head>\n'
        f'<body><h1>{escape(title)}</h1><div class="scroll">{body}</div></body></html>\n'
    )


def _cell(column: str, value: object) -> str:
    if column == "verdict":
        return f'<td class="{escape(str(value).replace(" ", "-"))}">{escape(str(value))}</td>'
    if isinstance(value, bool) or not isinstance(value, int | float):
        text = "" if _missing(value) else str(value)
        kind = ' class="long"' if len(text) > LONG_TEXT else ""
        return f"<td{kind}>{escape(text)}</td>"
    return f'<td class="number">{number_text(value)}</td>'


def _missing(value: object) -> bool:
    return value is None or (isinstance(value, float) and value != value)


def number_text(value: float) -> str:
    """Four significant digits; whole numbers without a point; nothing for no number."""
    if _missing(value):
        return ""
    return f"{value:.4g}" if isinstance(value, float) and not value.is_integer() else f"{value:.0f}"
