"""The page without a browser: valid, complete, equal to the tables, and never taking a name for markup."""

import re
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element

import html5lib
import numpy as np
import pandas as pd
import pytest
from report_contents import HOSTILE, PAPER, claims, contents, record

from walklab.report.contents import Contents, ReportTable
from walklab.report.page import label, render
from walklab.report.published import beside_figure
from walklab.report.sections import SECTIONS, placed
from walklab.report.tables import heading, headline, table_of


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Contents:
    return contents(tmp_path_factory.mktemp("figures"), run=HOSTILE)


@pytest.fixture(scope="module")
def page(made: Contents) -> str:
    return render(made)


def parsed(page: str) -> Element:
    """The page as a tree; the strict parser refuses what the standard calls a parse error."""
    return html5lib.HTMLParser(strict=True, namespaceHTMLElements=False).parse(page)


def rows_of(tree: Element, table: str | None = None) -> list[Element]:
    place = tree.find(f".//table[@id='{table}']") if table else tree
    return [row for row in place.iter("tr") if row.get("data-claim")]


def test_the_page_is_valid_and_its_identifiers_are_unique(page):
    tree = parsed(page)
    identifiers = [each.get("id") for each in tree.iter() if each.get("id")]
    assert len(identifiers) == len(set(identifiers))
    targets = {link.get("href")[1:] for link in tree.iter("a")}
    assert targets <= set(identifiers)
    assert all(image.get("alt") for image in tree.iter("img"))


def test_the_sections_say_who_wins_and_what_is_unlike_real_walks(page):
    sections = {each.get("id"): " ".join("".join(each.itertext()).split()) for each in parsed(page).iter("section")}
    assert (
        "the best baseline that knows only the task is P_Stat with residual spread (CRPS 0.200 s [0.100, 0.300])"
        in sections["forecasts"]
    )
    assert "that of these walks times: curvature 4." in sections["capture"]


def test_every_number_of_a_claim_is_that_of_the_table_of_claims(page):
    tree, table = parsed(page), claims().set_index("id")
    shown = rows_of(tree, "verdict-table")
    assert [row.get("data-claim") for row in shown] == list(table.index)
    # Beside figures and tables the same numbers stand again.
    assert len(rows_of(tree)) > len(shown)
    for row in rows_of(tree):
        claim, cells = table.loc[row.get("data-claim")], row.findall("td")
        assert cells[2].get("data-sort") == claim["published"]
        assert float(cells[3].get("data-sort")) == pytest.approx(claim["ours"], rel=0, abs=0, nan_ok=True)
        text = "".join(cells[3].itertext())
        numbers = [float(number) for number in re.findall(r"-?[\d.]+(?:e[+-]\d+)?", text)]
        expected = [value for value in (claim["ours"], claim["ours_low"], claim["ours_high"]) if np.isfinite(value)]
        assert numbers == pytest.approx(expected, rel=1e-3)
        assert claim["verdict"] in "".join(cells[4].itertext())


def test_names_and_texts_of_a_run_are_never_markup(page):
    tree = parsed(page)
    assert not [each for each in tree.iter() if any(name.startswith("on") for name in each.attrib)]
    assert "<img src=x" not in page
    assert HOSTILE in "".join(tree.find(".//table[@class='sortable']/..").itertext()) or HOSTILE in "".join(tree.itertext())
    assert len(list(tree.iter("script"))) == 2, "a name has closed the script"


def test_nothing_refers_to_anything_outside(page):
    tree = parsed(page)
    for each in tree.iter():
        for name in ("src", "href", "action", "data", "srcset"):
            value = each.get(name, "")
            assert not value or value.startswith(("#", "data:image/")), value[:80]
    style = "".join(each.text for each in tree.iter("style"))
    assert "url(" not in style
    assert "@import" not in style
    policy = next(meta.get("content") for meta in tree.iter("meta") if meta.get("http-equiv"))
    assert policy.startswith("default-src 'none'")
    assert "unsafe" not in policy


def test_a_figure_that_no_section_names_is_shown_all_the_same(page):
    more = parsed(page).find(".//section[@id='more']")
    assert more is not None
    assert more.find(".//figure[@id='figure-fig99']") is not None


def test_a_table_that_no_section_names_is_shown_all_the_same(made):
    extra = ReportTable("Extra", "extra.csv", pd.DataFrame({"a": [1]}))
    more = parsed(render(replace(made, tables={**made.tables, "extra": extra}))).find(".//section[@id='more']")
    assert more.find(".//div[@id='table-extra']") is not None


def test_real_walks_have_a_page_without_what_only_the_paper_has(made):
    few = {"scores": made.tables["scores"]}
    page = render(Contents(record(kind="table"), {}, {}, few, made.maps, []))
    tree = parsed(page)
    present = {section.get("id") for section in tree.iter("section")}
    assert {"question", "forecasts", "record"} <= present
    assert not present & {"verdicts", "scenarios", "statistics", "inconsistencies"}
    assert "no verdicts here" in page


def test_a_run_with_next_to_nothing_still_has_a_page():
    tree = parsed(render(Contents(record(), {}, {}, {})))
    assert "no model to look into" not in "".join(tree.itertext())
    assert tree.find(".//section[@id='record']") is not None


def test_every_figure_has_exactly_one_place():
    names = {name: "Model" for section in SECTIONS for name in section.figures} | {"new": "Analyses", "odd": "?"}
    found = [name for shown in placed(names).values() for name in shown]
    assert sorted(found) == sorted(names)
    assert "new" in placed(names)["long_distance"]
    assert placed(names)["more"] == ["odd"]


def test_published_inputs_stand_beside_ours(made):
    rows = beside_figure("fig04", made.paper, made.frames, made.record["config"])
    assert [(row.published, row.ours) for row in rows] == [(30, 30), (1848, 1848), (4.97, 4.9)]
    cells = beside_figure("fig05", made.paper, made.frames, made.record["config"])
    assert (cells[0].published, cells[0].ours) == (1000, 6)


def test_a_value_and_its_interval_share_a_cell():
    frame = pd.DataFrame(
        {"model": ["a"], "crps_s": [0.2], "crps_s_low": [0.1], "crps_s_high": [0.3], "empty": [np.nan], "n": [3]}
    )
    table = table_of(frame, "t", "T", "t.csv")
    assert table.headings == ("model", "CRPS (s) [95 %]", "walks")
    assert [cell.text for cell in table.rows[0]] == ["a", "0.2 [0.1, 0.3]", "3"]
    assert [cell.sort for cell in table.rows[0]] == ["a", "0.2", "3.0"]


@pytest.mark.parametrize(
    ("column", "words"), [("dt_s", "dt (s)"), ("curvature_1_m", "curvature (1/m)"), ("p", "p"), ("on_edge", "on edge")]
)
def test_units_are_set_in_brackets(column, words):
    assert heading(column) == words


def test_models_are_set_with_an_index_and_other_names_are_escaped():
    assert label("P_Prob (calibrated)") == "P<sub>Prob</sub> (calibrated)"
    assert label("P_<b>") == "P<sub>&lt;b&gt;</sub>"
    assert label("best_cell") == "best cell"


def test_style_and_script_ship_with_the_package():
    folder = Path(render.__code__.co_filename).parent / "assets"
    assert {"style.css", "maps.js", "report.html"} <= {path.name for path in folder.iterdir()}
    assert not re.search(r"https?://", "".join(path.read_text() for path in folder.rglob("*.*")))


def test_names_of_files_are_read_as_words():
    frame = pd.DataFrame(
        {"sub_model": ["without_v", "k_nearest_by_participant", "P_Prob"], "p_walks": [0.0, 2e-4, 0.04], "p95": 1.5}
    )
    table = table_of(frame, "t", "T", "t.csv")
    assert table.headings == ("sub model", "p walks", "95th percentile")
    assert [row[0].text for row in table.rows] == ["without v", "k nearest, participant left out", "P_Prob"]
    assert [row[1].text for row in table.rows] == ["< 0.001", "< 0.001", "0.04"]
    assert table.rows[1][1].sort == "0.0002"
    assert table_of(pd.DataFrame({"pit_distance": [0.0], "power": [0.0]}), "t", "T", "t.csv").rows[0][0].text == "0"


def test_the_headline_has_the_interval_of_each_median_and_the_score_of_each_forecast():
    models = ("P_Stat", "P_Adapt", "P_Prob", "P_Prob (calibrated)")
    described = pd.DataFrame({"model": models, "median": 0.15})
    percentiles = pd.DataFrame(
        {"model": models * 2, "statistic": ["p95"] * 4 + ["median"] * 4, "low": [9] * 4 + [1, 2, 3, 4], "high": 5}
    )
    names = ["P_Stat with residual spread", "P_Adapt", "P_Prob (literal)", "P_Prob (extended)", "regression"]
    scores = pd.DataFrame(
        [
            ("scenario_1", hull, name, 0.1 * place + shift, 0.05, 0.5)
            for hull, shift in (("inside", 5), ("all", 0))
            for place, name in enumerate(names)
        ],
        columns=["scenario", "hull", "model", "crps_s", "crps_s_low", "crps_s_high"],
    )
    tables = {"description_scenario_1": described, "percentiles_scenario_1": percentiles, "scores": scores}

    def rows(*kept: str) -> list[dict]:
        return headline(Contents(record(), PAPER, {}, {name: ReportTable(name, name, tables[name]) for name in kept}))

    found = {row["model"]: row for row in rows(*tables)}
    assert list(found) == [*models, "P_Prob (extended)"]
    assert [(found[name]["low"], found[name]["high"]) for name in models] == [(1, 5), (2, 5), (3, 5), (4, 5)]
    assert [found[name]["crps"][0] for name in found] == pytest.approx([0.0, 0.1, 0.2, None, 0.3])
    assert found["P_Prob (extended)"]["ours"] is None
    assert [(row["low"], row["crps"]) for row in rows("description_scenario_1")] == [(None, [None] * 3)] * 4
