"""The PDF: the same bytes for the same run, every figure in it, no table wider than the page."""

from dataclasses import replace

import pandas as pd
import pytest
from report_contents import contents, record

from walklab.report import pdf
from walklab.report.contents import Contents, ReportTable
from walklab.report.pdf import FRAME_WIDTH, _register_fonts, _widths, pdf_of
from walklab.report.tables import headline, with_interval


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Contents:
    return contents(tmp_path_factory.mktemp("figures"))


def test_the_same_run_gives_the_same_bytes(made):
    assert pdf_of(made) == pdf_of(made)


def test_every_figure_is_in_it(made):
    found = pdf_of(made)
    assert found.startswith(b"%PDF")
    assert found.count(b"/Subtype /Image") == len(made.figures)


def test_long_texts_wrap_inside_the_page(made):
    long = pd.DataFrame({"text": ["word " * 400, "x" * 600], "n": [1, 2]})
    assert pdf_of(replace(made, tables={"assumptions": ReportTable("Long", "long.csv", long)})).count(b"/Type /Page\n") >= 1


def test_columns_fill_the_page_at_most():
    _register_fonts()
    narrow = _widths([("a", "b"), ("1", "2")], 7)
    assert sum(narrow) < FRAME_WIDTH / 4
    wide = _widths([("short", "long"), ("1", "word " * 300)], 7)
    assert sum(wide) == pytest.approx(FRAME_WIDTH, rel=1e-3)
    assert wide[0] == pytest.approx(_widths([("short",), ("1",)], 7)[0])


def test_a_run_with_next_to_nothing_has_a_pdf():
    assert pdf_of(Contents(record(kind="table"), {}, {}, {})).startswith(b"%PDF")


def test_it_opens_with_the_rows_of_the_page(made, monkeypatch):
    """Every text that goes into the PDF is seen on its way; the headline is the page's, scores and all."""
    texts = []
    paragraph = pdf._paragraph
    monkeypatch.setattr(pdf, "_paragraph", lambda text, *size, **more: texts.append(text) or paragraph(text, *size, **more))
    pdf_of(made)
    rows = headline(made)
    assert rows
    for row in rows:
        assert row["model"] == "P_Prob" or row["model"] in texts
        assert (with_interval(row["ours"], row["low"], row["high"]) or "–") in texts
