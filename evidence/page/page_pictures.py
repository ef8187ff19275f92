"""Pictures of the page of `restitution app`, in three widths and both themes.

    python evidence/page/page_pictures.py OUT

Writes OUT/WIDTH-THEME.png, and docs/images/app.png for the README. It needs Chromium and the extras
`app` and `test`.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from playwright.sync_api import Browser, Page, expect, sync_playwright

ROOT = Path(__file__).parents[2]
SIZES = {1400: 900, 820: 1180, 390: 844}  # laptop, tablet, phone
THEMES = ("light", "dark")


def ready(page: Page) -> None:
    """Wait until the whole run is drawn."""
    expect(page.locator("#status")).to_have_text(re.compile("^complete"), timeout=180_000)


def opened(browser: Browser, address: str, width: int, theme: str) -> Page:
    """The page with a pinned curve beside a rougher one."""
    page = browser.new_page(viewport={"width": width, "height": SIZES[width]}, color_scheme=theme)
    page.goto(address)
    ready(page)
    page.click("#pin")
    page.fill("#field-roughness-rms", "0.05 um")
    page.wait_for_timeout(500)
    ready(page)
    page.mouse.move(0, 0)
    return page


def main(out: Path) -> None:
    """Take all pictures."""
    out.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "restitution", "app", "--no-browser"]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    address = server.stdout.readline().split()[-1]
    try:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(
                executable_path="/usr/bin/chromium", args=["--no-sandbox"]
            )
            for width in SIZES:
                for theme in THEMES:
                    page = opened(browser, address, width, theme)
                    page.screenshot(path=out / f"{width}-{theme}.png", full_page=width < 1000)
                    if (width, theme) == (1400, "light"):
                        page.screenshot(path=ROOT / "docs" / "images" / "app.png")
                    page.close()
            browser.close()
    finally:
        server.terminate()
        server.wait(20)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
