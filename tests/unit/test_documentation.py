"""The pages of docs/ are found from the site's menu and from its first page, and lead nowhere that the site has not."""

import re
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(path.name for path in DOCS.glob("*.md"))


def pages_of(menu):
    """Files named in a menu of mkdocs, in which sections nest."""
    if isinstance(menu, str):
        return [menu]
    parts = menu.values() if isinstance(menu, dict) else menu
    return [page for part in parts for page in pages_of(part)]


def links(page):
    """Files that a page links to, relative to it."""
    targets = re.findall(r"\]\(([^)\s]+)\)", (DOCS / page).read_text())
    return [target.split("#")[0] for target in targets if "://" not in target and not target.startswith("#")]


def test_nested_menus_are_read_whole():
    assert pages_of([{"one": "a.md"}, {"more": [{"two": "b.md"}, "c.md"]}]) == ["a.md", "b.md", "c.md"]


def test_the_menu_of_the_site_lists_every_page_once():
    assert sorted(pages_of(yaml.safe_load((ROOT / "mkdocs.yml").read_text())["nav"])) == PAGES


def test_the_first_page_links_every_other():
    assert set(links("index.md")) == set(PAGES) - {"index.md"}


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_to_what_the_site_has(page):
    dead = [link for link in links(page) if not ((DOCS / link).resolve().is_relative_to(DOCS) and (DOCS / link).is_file())]
    assert dead == []
