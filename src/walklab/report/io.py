"""What the report reads from a run's folder, and what it writes there."""

from __future__ import annotations

import base64
import re
from collections.abc import Mapping
from html import unescape
from pathlib import Path

from docutils.core import publish_parts

from walklab.errors import InputError
from walklab.report.contents import ReportFigure, ReportTable
from walklab.storage import read_table

ENLARGED = 1.4  # figures are drawn for a column of paper, with letters too small for a screen
HEAVY_BYTES = 400_000  # a drawing of more is embedded as an image
RST = {"raw_enabled": False, "file_insertion_enabled": False, "report_level": 5, "halt_level": 5}


def read_caption(path: str | Path) -> tuple[str, str]:
    """A caption in reStructuredText as HTML without outer paragraphs, and as plain text."""
    try:
        source = Path(path).read_text()
    except OSError as error:
        raise InputError(f"{path}: no such caption; write one, as for the other figures") from error
    body = publish_parts(source, writer_name="html5", settings_overrides=RST)["body"].strip()
    inner = re.sub(r"^<p>|</p>$", "", body)
    return inner, " ".join(unescape(re.sub(r"<[^>]+>", "", inner)).split())


def read_figure(name: str, category: str, path_svg: str | Path, caption: str | Path) -> ReportFigure:
    """A figure as a data URI: its drawing, or its image where the drawing is heavy."""
    drawing = Path(path_svg)
    try:
        content = drawing.read_bytes()
        width, height = _size_px(content)
        kind = "svg+xml"
        if len(content) > HEAVY_BYTES:
            content, kind = drawing.with_suffix(".png").read_bytes(), "png"
    except (OSError, ValueError) as error:
        raise InputError(f"{drawing}: not a readable figure ({error}); draw it again") from error
    html, text = read_caption(caption)
    uri = f"data:image/{kind};base64,{base64.b64encode(content).decode()}"
    return ReportFigure(name, category, html, text, uri, (width, height))


def _size_px(svg: bytes) -> tuple[int, int]:
    """CSS pixels to show a drawing at whose size is given in points."""
    head = svg[:2000].decode(errors="replace")
    found = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', head)
    if not found:
        raise ValueError("no viewBox")
    return round(float(found[1]) * ENLARGED * 96 / 72), round(float(found[2]) * ENLARGED * 96 / 72)


def read_tables(files: Mapping[str, tuple[str, str]]) -> dict[str, ReportTable]:
    """The named tables, ``{name: (file, title)}``."""
    return {name: ReportTable(title, file, read_table(file)) for name, (file, title) in files.items()}
