"""The report of a finished study: its numbers are those of the run's tables, and a real browser finds nothing to object to."""

import re
from pathlib import Path

import html5lib
import numpy as np
import pandas as pd
import pytest
from browser import chromium, needs_chromium

pytestmark = pytest.mark.workflow

MOST_BYTES = 15_000_000


@pytest.fixture
def results(finished) -> Path:
    return finished.folder / "results/tiny"


def test_every_published_figure_stands_beside_the_runs_own_number(results):
    claims = pd.read_csv(results / "claims.csv", dtype={"published": str}).fillna({"published": ""}).set_index("id")
    tree = html5lib.HTMLParser(strict=True, namespaceHTMLElements=False).parse((results / "report.html").read_text())
    rows = [row for row in tree.iter("tr") if row.get("data-claim")]
    whole = [row for row in tree.find(".//table[@id='verdict-table']").iter("tr") if row.get("data-claim")]
    assert [row.get("data-claim") for row in whole] == list(claims.index)
    for row in rows:
        claim, cells = claims.loc[row.get("data-claim")], row.findall("td")
        assert cells[2].get("data-sort") == claim["published"]
        shown = float(cells[3].get("data-sort"))
        assert shown == claim["ours"] or (np.isnan(shown) and np.isnan(claim["ours"]))
        assert row.get("data-verdict") == claim["verdict"]
    # Every number with a figure of the paper stands beside that figure too.
    beside = [row.get("data-claim") for row in rows if row not in whole]
    assert {name for name in claims.index if name.startswith(("scenario_", "ablation_", "k_sweep_", "long_distance_"))} <= set(
        beside
    )


def test_every_figure_of_the_run_is_in_its_report(results):
    page = (results / "report.html").read_text()
    drawn = {path.stem for path in (results / "figures").glob("*.svg")}
    assert {"fig03", "fig11", "claims"} <= drawn
    assert set(re.findall(r'id="figure-(\w+)"', page)) == drawn
    assert (results / "report.html").stat().st_size < MOST_BYTES
    assert (results / "report.pdf").read_bytes().count(b"/Subtype /Image") == len(drawn)


@needs_chromium
def test_a_browser_opens_it_without_errors_and_without_the_network(results):
    with chromium() as browser:
        for scheme in ("light", "dark"):
            browser.open((results / "report.html").resolve(), 400, scheme)
            assert browser.messages() == []
            assert browser.requests() == [(results / "report.html").resolve().as_uri()]
            assert browser.run("return document.documentElement.scrollWidth") <= 400
            browser.run("for (const fold of document.querySelectorAll('details')) { fold.open = true; }")
            assert [each for each in browser.contrasts() if each["ratio"] < each["needed"]] == []
        assert browser.run("return document.querySelectorAll('.player .outcome tbody tr').length") >= 8
        assert browser.printed().startswith(b"%PDF")
