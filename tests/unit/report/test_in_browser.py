"""The page in a real Chromium: no errors, no requests, usable by keyboard, legible in both modes, on phones and on paper."""

from __future__ import annotations

import shutil
import subprocess
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest
from browser import Browser, chromium, needs_chromium
from report_contents import HOSTILE, contents
from selenium.webdriver.common.keys import Keys

from walklab.report.contents import ReportTable
from walklab.report.page import render

pytestmark = needs_chromium


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with chromium() as found:
        yield found


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("page")
    path = folder / "report.html"
    path.write_text(render(contents(folder, run=HOSTILE)))
    return path


def test_no_script_fails_and_nothing_is_requested(browser, page):
    browser.open(page)
    assert browser.run("return document.querySelectorAll('.player canvas').length") == 2
    assert browser.messages() == []
    assert browser.requests() == [page.as_uri()]
    assert browser.run("return document.title") == f"walklab report: {HOSTILE}"


def test_the_check_of_requests_and_messages_can_fail(browser, tmp_path):
    # The twin of the test above: a page that does ask for something and does fail.
    bad = tmp_path / "bad.html"
    bad.write_text("<!DOCTYPE html><title>bad</title><img src='absent.png' alt=''><script>undefined_function()</script>")
    browser.open(bad)
    assert any(address.endswith("absent.png") for address in browser.requests())
    assert any("undefined_function" in message for message in browser.messages())


def test_the_policy_stops_scripts_styles_and_requests_that_are_not_the_pages(browser, page):
    browser.open(page)
    browser.run(
        """
        const script = document.createElement("script"), image = document.createElement("img");
        script.textContent = "window.intruded = true";
        image.src = "absent.png";
        document.body.append(script, image);
        """
    )
    assert browser.run("return window.intruded === undefined")
    refused = []
    browser.wait(lambda: len(refused.extend(browser.messages()) or refused) >= 2)
    assert all("Content Security Policy" in message for message in refused)


@pytest.mark.parametrize("width", [400, 768, 1280])
def test_nothing_is_wider_than_the_window(browser, page, width):
    browser.open(page, width)
    assert browser.run("return document.documentElement.scrollWidth") <= width
    # What is wider than its frame is moved about in it, and the frame can be focused.
    loose = browser.run(
        """
        return Array.from(document.querySelectorAll("main *"))
          .filter((e) => e.scrollWidth > e.clientWidth + 1 && ["auto", "scroll"].includes(getComputedStyle(e).overflowX))
          .filter((e) => e.tabIndex < 0).map((e) => e.className);
        """
    )
    assert loose == []


def outside(browser, cells):
    """Texts of the cells that are not wholly between the left and the right edge of their frame."""
    return browser.run(
        """
        return Array.from(document.querySelectorAll(arguments[0])).filter((cell) => cell.textContent.trim()).filter((cell) => {
          const box = cell.getBoundingClientRect(), frame = cell.closest(".scroll").getBoundingClientRect();
          const range = document.createRange();
          range.selectNodeContents(cell);
          const text = range.getBoundingClientRect();
          const left = Math.min(box.left, text.left), right = Math.max(box.right, text.right);
          return box.width === 0 || left < Math.max(0, frame.left) || right > Math.min(innerWidth, frame.right);
        }).map((cell) => cell.textContent.trim());
        """,
        cells,
    )


def test_on_a_phone_results_are_seen_without_moving_a_table(browser, page):
    browser.open(page, 400)
    for cells in (
        "#verdict-table td:nth-child(3), #verdict-table td.ours, #verdict-table td:last-child",
        "#medians td:nth-child(n + 2)",
        ".outcome tr:nth-child(n + 2) td",
    ):
        assert browser.run("return document.querySelectorAll(arguments[0]).length", cells) > 0
        assert outside(browser, cells) == []
    # The twin: a table that is not stacked is wider than the window, and the check sees it.
    browser.run("for (const fold of document.querySelectorAll('details')) { fold.open = true; }")
    assert outside(browser, "#table-scores td") != []


@pytest.mark.parametrize("width", [400, 1280])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_all_text_has_contrast(browser, page, scheme, width):
    browser.open(page, width, scheme)
    browser.run("for (const fold of document.querySelectorAll('details')) { fold.open = true; }")
    found = browser.contrasts()
    assert len(found) > 100
    assert [each for each in found if each["ratio"] < each["needed"]] == []


def test_the_check_of_contrast_can_fail(browser, page):
    browser.open(page)
    browser.run("document.querySelector('h1').style = 'color: #999; font-size: 14px'")  # set by script: the policy allows that
    assert [each["tag"] for each in browser.contrasts() if each["ratio"] < each["needed"]] == ["H1"]


def test_the_switch_of_colours_goes_round_and_is_remembered(browser, page):
    browser.open(page, scheme="light")
    ground = "return getComputedStyle(document.body).backgroundColor"
    light = browser.run(ground)
    seen = []
    browser.run("document.getElementById('theme').focus()")
    for _ in range(3):
        browser.press(Keys.ENTER)
        seen.append((browser.run("return document.querySelector('#theme span').textContent"), browser.run(ground) == light))
    assert seen == [("light", True), ("dark", False), ("system", True)]
    browser.prefer("dark")
    assert browser.run(ground) != light


def test_the_first_tab_skips_to_the_report(browser, page):
    browser.open(page)
    browser.press(Keys.TAB)
    assert browser.focused("e.className") == "skip"
    assert browser.run("return document.activeElement.getBoundingClientRect().top") >= 0
    browser.press(Keys.ENTER)
    assert browser.focused("e.id") == "main"


def test_every_control_has_a_name_and_can_be_seen_to_have_the_focus(browser, page):
    browser.open(page)
    names = browser.run(
        """
        return Array.from(document.querySelectorAll("button, input, select, summary, a[href]"))
          .filter((e) => e.checkVisibility())
          .map((e) => (e.labels && e.labels.length ? e.labels[0].textContent : e.textContent).trim());
        """
    )
    assert len(names) > 30
    assert all(names)
    for _ in range(40):
        browser.press(Keys.TAB)
        outline = browser.focused("[getComputedStyle(e).outlineStyle, parseFloat(getComputedStyle(e).outlineWidth)]")
        assert outline[0] != "none", browser.focused("e.outerHTML.slice(0, 80)")
        assert outline[1] >= 2


def test_a_slider_is_moved_by_key_and_changes_the_map(browser, page):
    browser.open(page)
    picture = "return document.getElementById('maps-cube').toDataURL()"
    before, readout = browser.run(picture), browser.run("return document.getElementById('maps-readout').textContent")
    browser.tab_to("e.matches('#maps-controls input[type=range]')")
    said = browser.focused("e.getAttribute('aria-valuetext')")
    browser.press(Keys.ARROW_RIGHT)
    assert browser.focused("e.getAttribute('aria-valuetext')") != said
    assert browser.run(picture) != before
    assert browser.run("return document.getElementById('maps-readout').textContent") != readout
    assert "m/s" in readout


def test_the_sharper_model_shows_another_density(browser, page):
    browser.open(page)
    picture = "return document.getElementById('maps-slices').toDataURL()"
    before = browser.run(picture)
    browser.tab_to("e.matches('#maps-controls select')")
    browser.press(Keys.ARROW_DOWN)
    browser.wait(lambda: browser.run(picture) != before)
    assert browser.focused("e.selectedIndex") == 1


def test_a_table_is_sorted_by_key_both_ways(browser, page):
    browser.open(page)
    browser.tab_to("e.matches('#medians .sort') && e.textContent.startsWith('ours')")
    column = "return Array.from(document.querySelectorAll('#medians tbody tr'), (row) => Number(row.cells[3].dataset.sort))"
    browser.press(Keys.ENTER)
    assert browser.focused("e.closest('th').getAttribute('aria-sort')") == "ascending"
    up = browser.run(column)
    assert up == sorted(up)
    browser.press(Keys.SPACE)
    assert browser.focused("e.closest('th').getAttribute('aria-sort')") == "descending"
    assert browser.run(column) == up[::-1]


def test_missing_values_sort_last_either_way(browser, page):
    browser.open(page)
    place = "#verdict-table th:nth-child(4) .sort"
    for _ in range(2):
        browser.run("document.querySelector(arguments[0]).click()", place)
        values = browser.run(
            "return Array.from(document.querySelectorAll('#verdict-table tbody tr'), (row) => row.cells[3].dataset.sort)"
        )
        assert values[-2:] == ["nan", "nan"]
        assert "nan" not in values[:-2]


def test_claims_are_filtered_by_verdict_and_words(browser, page):
    browser.open(page)
    shown = "return Array.from(document.querySelectorAll('#verdict-table tbody tr')).filter((row) => !row.hidden).length"
    every = browser.run(shown)
    browser.tab_to("e.matches('#verdict-filter input[value=\"not reproduced\"]')")
    browser.press(Keys.SPACE)
    assert 0 < browser.run(shown) < every
    browser.tab_to("e.matches('#verdict-filter input[type=search]')")
    browser.press("normally")
    assert browser.run(shown) == 1


def test_a_player_plays_pauses_and_is_scrubbed_by_key(browser, page):
    browser.open(page)
    time_of = "return Number(document.querySelector('.player input[type=range]').value)"
    whole = browser.run(time_of)  # a player starts with a still picture of the whole walk
    browser.tab_to("e.matches('.player select') && e.options[2].text === '¼ ×'")
    browser.press(Keys.END)
    browser.run("document.querySelector('.player button[aria-pressed]').focus()")
    browser.press(Keys.SPACE)
    assert browser.focused("e.textContent") == "Pause"
    browser.wait(lambda: 2 < browser.run(time_of) < whole)
    browser.press(Keys.SPACE)
    at = browser.run(time_of)
    assert browser.focused("e.textContent") == "Play"
    time.sleep(0.3)
    assert browser.run(time_of) == at, "a paused walk goes on"
    browser.tab_to("e.matches('.player input[type=range]')")
    browser.press(Keys.HOME)
    assert browser.run(time_of) == 0 < at
    browser.press(Keys.END)
    assert browser.run(time_of) == whole


def test_another_walk_shows_its_own_times(browser, page):
    browser.open(page)
    captured = "return document.querySelector('.player .outcome tbody td:nth-child(2)').textContent"
    first = browser.run(captured)
    browser.tab_to("e.matches('.player button') && e.textContent === 'Previous walk'")
    browser.press(Keys.ENTER)
    assert browser.run(captured) != first


def test_on_paper_there_are_no_controls_and_everything_is_unfolded(browser, page):
    browser.open(page, scheme="dark")
    printed = browser.printed()
    assert printed.startswith(b"%PDF")
    assert len(printed) > 50_000
    browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        assert browser.run("return getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
        assert browser.run(
            "return Array.from(document.querySelectorAll('.controls, .filters, #theme')).every((e) => !e.checkVisibility())"
        )
        assert browser.run("return Array.from(document.querySelectorAll('main details')).every((e) => e.open)")
    finally:
        browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})


# Width of an A4 page less its margins; wide tables of many rows stand across.
UPRIGHT_PX, ACROSS_PX = 688, 1046


@pytest.mark.parametrize(("columns", "width_px"), [(10, UPRIGHT_PX), (18, ACROSS_PX), (26, ACROSS_PX)])
def test_on_paper_no_table_is_wider_than_its_section(browser, tmp_path, columns, width_px):
    names = [f"median signed dt {number}" for number in range(columns - 1)]
    frame = pd.DataFrame([{"model": "P_Prob (calibrated)", **dict.fromkeys(names, 0.1459), "last": 1.234e-42}] * 90)
    made = replace(contents(tmp_path), tables={"scores": ReportTable("Scores", "scores.csv", frame)})
    path = tmp_path / "report.html"
    path.write_text(render(made))
    browser.open(path, width_px)
    browser.run("for (const fold of document.querySelectorAll('details')) { fold.open = true; }")
    browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        excess = browser.run(
            """
            return Array.from(document.querySelectorAll("section table"))
              .map((e) => e.getBoundingClientRect().right - e.closest("section").getBoundingClientRect().right);
            """
        )
    finally:
        browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
    assert excess
    assert max(excess) < 1
    if shutil.which("pdftotext") is None:
        pytest.skip("the text on paper is read by pdftotext of Debian's package poppler-utils")
    printed = tmp_path / "printed.pdf"
    printed.write_bytes(browser.printed())
    text = subprocess.run(["pdftotext", "-layout", printed, "-"], capture_output=True, text=True, check=True).stdout
    pages = [page for page in text.split("\f") if "1.234e-42" in page]
    assert len(pages) > 1
    assert all("last" in page for page in pages), "the head of a table is repeated on every page"
