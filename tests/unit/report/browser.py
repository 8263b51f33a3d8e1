"""A real Chromium, driven over its DevTools protocol: what a reader's browser does with a page."""

from __future__ import annotations

import base64
import json
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
MISSING = None if CHROMIUM and DRIVER else "needs Debian's packages chromium and chromium-driver"
needs_chromium = pytest.mark.skipif(MISSING is not None, reason=str(MISSING))

# Every element with text of its own that is visible: its colour against the ground it stands on, WCAG 2.
CONTRASTS = """
function channels(text) { return (text.match(/[\\d.]+/g) || [0, 0, 0, 0]).map(Number); }
function luminance(rgb) {
  const [r, g, b] = rgb.map((v) => { v /= 255; return v <= 0.04045 ? v / 12.92 : Math.pow((v + 0.055) / 1.055, 2.4); });
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}
function ground(element) {
  for (let at = element; at; at = at.parentElement) {
    const [r, g, b, a = 1] = channels(getComputedStyle(at).backgroundColor);
    if (a === 1) { return [r, g, b]; }
    if (a !== 0) { throw new Error("half-transparent ground"); }
  }
  return [255, 255, 255];
}
const found = [];
for (const element of document.body.querySelectorAll("*")) {
  const own = Array.from(element.childNodes).filter((n) => n.nodeType === 3).map((n) => n.textContent).join("").trim();
  if (!own || ["SCRIPT", "STYLE", "NOSCRIPT", "OPTION"].includes(element.tagName) || !element.checkVisibility()) { continue; }
  const style = getComputedStyle(element), size = parseFloat(style.fontSize);
  const a = luminance(channels(style.color).slice(0, 3)), b = luminance(ground(element));
  const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  const large = size >= 24 || (size >= 18.66 && parseInt(style.fontWeight, 10) >= 700);
  found.push({ text: own.slice(0, 40), tag: element.tagName, ratio, needed: large ? 3 : 4.5 });
}
return found;
"""


@dataclass(frozen=True)
class Browser:
    """One page in a window of a given size."""

    driver: webdriver.Chrome

    def open(self, page: Path, width: int = 1280, scheme: str = "light") -> None:
        """Load a page from disk; earlier messages and requests are forgotten."""
        self.driver.get("about:blank")
        for kind in ("browser", "performance"):
            self.driver.get_log(kind)
        size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        self.prefer(scheme)
        self.driver.get(page.as_uri())

    def prefer(self, scheme: str) -> None:
        """What the system says of light and dark."""
        features = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", features)

    def run(self, script: str, *arguments: Any) -> Any:
        return self.driver.execute_script(script, *arguments)

    def messages(self) -> list[str]:
        """Errors and warnings of scripts, and what the page's policy refused."""
        return [entry["message"] for entry in self.driver.get_log("browser")]

    def requests(self) -> list[str]:
        """Addresses that were asked for, whatever came of it; what is inside the page (data:) is not asked for."""
        entries = [json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")]
        asked = [entry["params"]["request"]["url"] for entry in entries if entry["method"] == "Network.requestWillBeSent"]
        return [address for address in asked if not address.startswith("data:")]

    def press(self, *keys: str) -> None:
        ActionChains(self.driver).send_keys(*keys).perform()

    def focused(self, expression: str) -> Any:
        """A JavaScript expression of the focused element ``e``."""
        return self.run(f"const e = document.activeElement; return {expression};")

    def tab_to(self, expression: str, most: int = 400) -> int:
        """Press Tab until the expression of the focused element ``e`` holds; how often it took."""
        for count in range(1, most + 1):
            self.press(Keys.TAB)
            if self.focused(expression):
                return count
        raise AssertionError(f"no Tab out of {most} reached {expression}")

    def wait(self, condition: Callable[[], bool], seconds: float = 20.0) -> None:
        deadline = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < deadline, "the page did not get there"
            time.sleep(0.05)

    def contrasts(self) -> list[dict[str, Any]]:
        return self.run(CONTRASTS)

    def printed(self) -> bytes:
        """The page as a PDF on A4."""
        size = {"paperWidth": 8.27, "paperHeight": 11.69, "preferCSSPageSize": True}
        return base64.b64decode(self.driver.execute_cdp_cmd("Page.printToPDF", size)["data"])


@contextmanager
def chromium() -> Iterator[Browser]:
    options = Options()
    options.binary_location = str(CHROMIUM)
    for argument in (
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-dev-shm-usage",
        "--disable-background-networking",
    ):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(str(DRIVER)))
    try:
        yield Browser(driver)
    finally:
        driver.quit()
