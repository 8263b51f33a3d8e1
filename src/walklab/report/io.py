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
from walklab.storage import atomic_path, read_table

HEAVY_BYTES = 400_000  # a drawing of more is embedded as an image
RST = {"raw_enabled": False, "file_insertion_enabled": False, "report_level": 5, "halt_level": 5}


def read_caption(path: str | Path) -> tuple[str, str]:
    """A caption in reStructuredText as HTML without outer paragraphs, and as plain text."""
    try:
        source = Path(path).read_text()
    except OSError as error:
        raise InputError(f"{path}: no such caption; write one, as for the other figures") from error
    body = publish_parts(source, writer="html5", settings_overrides=RST)["body"].strip()
    inner = re.sub(r"^<p>|</p>$", "", body)
    return inner, " ".join(unescape(re.sub(r"<[^>]+>", "", inner)).split())


def read_figure(name: str, category: str, path_svg: str | Path, caption: str | Path) -> ReportFigure:
    """A figure as a data URI, its drawing or, where that is heavy, its image; and the image for print."""
    path = Path(path_svg)
    try:
        drawing, image = path.read_bytes(), path.with_suffix(".png").read_bytes()
        size_mm = _size_mm(drawing)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: not a readable figure ({error}); draw it again") from error
    html, text = read_caption(caption)
    kind, shown = ("png", image) if len(drawing) > HEAVY_BYTES else ("svg+xml", drawing)
    uri = f"data:image/{kind};base64,{base64.b64encode(shown).decode()}"
    return ReportFigure(name, category, html, text, uri, image, size_mm)


def _size_mm(svg: bytes) -> tuple[float, float]:
    """Size of a drawing, which is given in points."""
    found = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', svg[:2000].decode(errors="replace"))
    if not found:
        raise ValueError("no viewBox")
    return float(found[1]) * 25.4 / 72, float(found[2]) * 25.4 / 72


def write_pdf(content: bytes, path: str | Path) -> None:
    """Write a PDF."""
    with atomic_path(path) as temporary:
        temporary.write_bytes(content)


def read_tables(files: Mapping[str, tuple[str, str]]) -> dict[str, ReportTable]:
    """The named tables, ``{name: (file, title)}``."""
    return {name: ReportTable(title, file, read_table(file)) for name, (file, title) in files.items()}
