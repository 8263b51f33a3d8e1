"""The main figures and tables of a run as a PDF: figures at the size they were drawn for, tables that wrap and are never cut."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import matplotlib
from PIL import Image as Picture
from reportlab import rl_config
from reportlab.lib.colors import HexColor
from reportlab.lib.pagesizes import A4
from reportlab.lib.styles import ParagraphStyle
from reportlab.lib.units import mm
from reportlab.pdfbase import pdfmetrics
from reportlab.pdfbase.ttfonts import TTFont
from reportlab.platypus import Flowable, Image, KeepTogether, LongTable, Paragraph, SimpleDocTemplate, Spacer, TableStyle

from walklab.figures.claims import VERDICTS
from walklab.figures.pages import number_text
from walklab.figures.style import read_name
from walklab.report.contents import Contents, ReportFigure
from walklab.report.published import Comparison, beside_figure, beside_table, claimed, published_text
from walklab.report.sections import SECTIONS, figure_title, placed, tables_of
from walklab.report.tables import SCORE_HEADINGS, Table, headline, score_rows, table_of, verdict_counts, with_interval

MARGIN = 15 * mm
FRAME_WIDTH, FIGURE_HEIGHT = A4[0] - 2 * MARGIN, 210 * mm
MOST_COLUMNS, MOST_ROWS = 10, 120  # larger tables stay in the page and in their files
FACES = {"": "DejaVuSans", "-Bold": "DejaVuSans-Bold"}  # they ship with matplotlib and have every sign that is needed
LINE, HEAD = HexColor("#b0b7be"), HexColor("#eef1f4")


def pdf_of(contents: Contents) -> bytes:
    """The PDF, the same bytes for the same run."""
    _register_fonts()
    target = BytesIO()
    name = str(contents.record["run"])
    document = SimpleDocTemplate(
        target,
        pagesize=A4,
        leftMargin=MARGIN,
        rightMargin=MARGIN,
        topMargin=MARGIN,
        bottomMargin=MARGIN,
        title=f"walklab: {name}",
        author="walklab",
        invariant=1,
    )
    document.build(_story(contents), onFirstPage=_footer(name), onLaterPages=_footer(name))
    return target.getvalue()


def _register_fonts() -> None:
    rl_config.useA85 = 0  # bytes as they are, not as letters: smaller, and a third of the time
    folder = Path(matplotlib.get_data_path()) / "fonts/ttf"
    for ending, face in FACES.items():
        pdfmetrics.registerFont(TTFont(face, str(folder / f"DejaVuSans{ending}.ttf")))


def _text(size: float, bold: bool = False, **more: Any) -> ParagraphStyle:
    return ParagraphStyle("text", fontName=FACES["-Bold" if bold else ""], fontSize=size, leading=size * 1.35, **more)


def _paragraph(text: str, size: float = 8.5, bold: bool = False, **more: Any) -> Paragraph:
    # A paragraph reads tags; names and texts of a run are data.
    return Paragraph(escape(text), _text(size, bold, **more))


def _story(contents: Contents) -> list[Flowable]:
    frames, config = contents.frames, contents.record["config"]
    commit = contents.record.get("commit") or {}
    about = f"Run {contents.record['run']}, seed {contents.record['seed']}"
    if commit:
        about += f", commit {commit['id'][:10]}{' with changes' if commit['dirty'] else ''}"
    story: list[Flowable] = [
        _paragraph("walklab: figures and tables of a run", 17, True, spaceAfter=4),
        _paragraph(about, spaceAfter=4),
    ]
    counts = verdict_counts(frames.get("claims"), list(VERDICTS))
    if counts:
        story.append(_paragraph("Claims of the paper: " + ", ".join(f"{count} {verdict}" for verdict, count in counts) + "."))
    if contents.paper:
        story += _headline(contents)
    where = placed({name: figure.category for name, figure in contents.figures.items()})
    for section in SECTIONS:
        parts: list[Flowable] = []
        title: list[Flowable] = [_paragraph(section.title, 13, True, spaceBefore=10, spaceAfter=5, keepWithNext=1)]
        for name in where[section.key]:
            rows = beside_figure(name, contents.paper, frames, config) if contents.paper else []
            # A heading stays with the figure that it heads.
            parts += [KeepTogether([*title, *_figure(contents.figures[name])]), *_comparisons(rows)]
            title = []
        if section.key == "verdicts":
            parts += _comparisons(claimed(frames.get("claims"), ("",)))
        if section.key == "forecasts":
            parts += _titled("Proper scores of all forecasts", SCORE_HEADINGS, score_rows(frames.get("scores")))
        for name in tables_of(section, list(contents.tables)):
            found = contents.tables[name]
            if name != "claims":
                parts += _table(table_of(found.frame, name, found.title, found.file))
                parts += _comparisons(beside_table(name, frames))
        if parts:
            story += [*title, *parts]
    return story


def _headline(contents: Contents) -> list[Flowable]:
    """The paper's main result, as the page opens with it."""
    cells = [
        (
            row["scenario"],
            read_name(row["model"]),
            "–" if row["published"] is None else number_text(row["published"]),
            with_interval(row["ours"], row["low"], row["high"]) or "–",
            with_interval(*row["crps"]) or "–",
        )
        for row in headline(contents)
    ]
    head = ("scenario", "model", "published (s)", "ours (s) [95 %]", "CRPS (s) [95 %]")
    return _titled("Median absolute travel-time error of one simulated walk, and the score of the whole forecast", head, cells)


def _titled(title: str, head: Sequence[str], cells: Sequence[Sequence[str]]) -> list[Flowable]:
    """A table under its title, texts first, then numbers; nothing for no rows."""
    if not cells:
        return []
    heading = _paragraph(title, 9, True, spaceBefore=8, spaceAfter=3, keepWithNext=1)
    numbers = {at for at, name in enumerate(head) if "(" in name}
    return [heading, _grid(head, cells, numbers), Spacer(0, 8)]


def _figure(figure: ReportFigure) -> list[Flowable]:
    """A figure at its own size, or as large as the page allows, over its caption."""
    width, height = (size * mm for size in figure.size_mm)
    scale = min(1.0, FRAME_WIDTH / width, FIGURE_HEIGHT / height)
    picture = BytesIO()
    Picture.open(BytesIO(figure.pixels)).convert("RGB").save(picture, "BMP")  # without packing: the PDF packs it
    image = Image(picture, width * scale, height * scale, hAlign="LEFT")
    caption = _paragraph(f"{figure_title(figure.name)}. {figure.summary}", 7.5, spaceBefore=3, spaceAfter=6)
    return [image, caption]


def _comparisons(rows: Sequence[Comparison]) -> list[Flowable]:
    """Published and ours; nothing for no rows."""
    if not rows:
        return []
    head = ("published in the paper", "section", "published", "ours [95 %]", "verdict")
    cells = [
        (
            row.statement,
            row.section,
            published_text(row.published),
            with_interval(row.ours, row.low, row.high),
            row.verdict or "input",
        )
        for row in rows
    ]
    return [_grid(head, cells, {2, 3}), Spacer(0, 8)]


def _table(table: Table) -> list[Flowable]:
    title = _paragraph(table.title, 9, True, spaceBefore=8, spaceAfter=3, keepWithNext=1)
    if len(table.headings) > MOST_COLUMNS and len(table.rows) < MOST_COLUMNS:
        # A wide table of few rows reads better turned.
        head = [table.headings[0], *(row[0].text for row in table.rows)]
        turned = [[name, *(row[at].text for row in table.rows)] for at, name in enumerate(table.headings) if at > 0]
        return [title, _grid(head, turned, set(range(1, len(head)))), Spacer(0, 8)]
    if len(table.headings) > MOST_COLUMNS or len(table.rows) > MOST_ROWS:
        return [title, _paragraph(f"{len(table.rows)} rows of {len(table.headings)} columns, in {table.file}.", 7.5)]
    numbers = {at for at in range(len(table.headings)) if any(row[at].kind == "number" for row in table.rows)}
    return [title, _grid(table.headings, [[cell.text for cell in row] for row in table.rows], numbers), Spacer(0, 8)]


def _grid(head: Sequence[str], rows: Sequence[Sequence[str]], numbers: set[int], size: float = 6.8) -> LongTable:
    """A table over the width of the page whose head is repeated on every page; long texts wrap."""

    def cell(text: str, at: int, bold: bool = False) -> Paragraph:
        return _paragraph(text, size, bold, alignment=2 if at in numbers else 0)

    widths = _widths([head, *rows], size)
    content = [[cell(text, at, True) for at, text in enumerate(head)]]
    content += [[cell(text, at) for at, text in enumerate(row)] for row in rows]
    style = [
        ("VALIGN", (0, 0), (-1, -1), "TOP"),
        ("BACKGROUND", (0, 0), (-1, 0), HEAD),
        ("LINEBELOW", (0, 0), (-1, -1), 0.3, LINE),
        ("LEFTPADDING", (0, 0), (-1, -1), 3),
        ("RIGHTPADDING", (0, 0), (-1, -1), 3),
        ("TOPPADDING", (0, 0), (-1, -1), 1.5),
        ("BOTTOMPADDING", (0, 0), (-1, -1), 2),
    ]
    return LongTable(content, colWidths=widths, repeatRows=1, hAlign="LEFT", style=TableStyle(style))


def _widths(rows: Sequence[Sequence[str]], size: float) -> list[float]:
    """What each column needs for its longest cell; where that is too much, the widest columns give way first."""
    face, padding = FACES["-Bold"], 7.0
    wanted = [max(pdfmetrics.stringWidth(row[at], face, size) for row in rows) + padding for at in range(len(rows[0]))]
    low, high = 0.0, max(wanted)
    for _ in range(40):  # the cap under which all columns fit, by bisection
        cap = (low + high) / 2
        low, high = (cap, high) if sum(min(width, cap) for width in wanted) <= FRAME_WIDTH else (low, cap)
    cap = max(wanted) if sum(wanted) <= FRAME_WIDTH else low
    return [min(width, cap) for width in wanted]


def _footer(name: str) -> Any:
    def draw(canvas: Any, document: Any) -> None:
        canvas.setFont(FACES[""], 7)
        canvas.setFillColor(HexColor("#57606a"))
        canvas.drawString(MARGIN, 9 * mm, f"walklab, run {name}")
        canvas.drawRightString(A4[0] - MARGIN, 9 * mm, str(document.page))

    return draw
