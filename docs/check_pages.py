"""Open every page of the built site, or a report, in headless Chromium, and say what a reader would
stumble over.

``python docs/check_pages.py docs/_build/html --out screenshots`` needs Chromium, its driver and
selenium; ``python docs/check_pages.py pit.html`` looks at one file. Each page is opened once and
looked at with 1,300 and 400 pixels, light and dark. What fails: pages wider than their window, text
that is cut off, navigation in two rows, requests to other machines, links that lead nowhere,
pictures that are missing, errors in the console. Screenshots are kept.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import threading
from collections.abc import Callable
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from itertools import product
from pathlib import Path
from urllib.parse import unquote, urldefrag, urljoin, urlparse

SIZES = {"wide": 1300, "narrow": 400}
SCHEMES = ("light", "dark")
#: What a page is asked: texts that are cut off, how far it stands out, heights of the navigation,
#: pictures without an image, links, and names that links can lead to.
ASK = """
const wide = document.documentElement.clientWidth, out = [];
for (const e of document.querySelectorAll('main *')) {
  const box = e.getBoundingClientRect();
  if (box.width && box.right > wide + 1) {
    let p = e.parentElement, inside = false;
    for (; p && !inside; p = p.parentElement)
      inside = /auto|scroll|hidden/.test(getComputedStyle(p).overflowX);
    if (!inside) out.push(e.tagName + '.' + e.className + ' ' + Math.round(box.right));
  }
}
const blocks = 'main :is(p, li, td, th, dd, pre, figure, figcaption)';
const cut = [...document.querySelectorAll(blocks)].filter(e =>
  /hidden|clip/.test(getComputedStyle(e).overflowX) && e.clientWidth
  && e.scrollWidth > e.clientWidth + 1);
const links = 'header :is(.nav-link, .search-button, .search-button-field)';
const bar = [...document.querySelectorAll(links)]
  .map(e => e.getBoundingClientRect()).filter(box => box.width)
  .map(box => Math.round(box.top + box.height / 2));
return {
  rows: Math.max(...bar) - Math.min(...bar) > 16 ? bar : [],
  cut: cut.map(e => e.tagName + '.' + e.className + ' ' + e.textContent.trim().slice(0, 40)),
  overflow: document.documentElement.scrollWidth > wide + 1
    ? ['page ' + document.documentElement.scrollWidth, ...out] : out,
  pictures: [...document.images]
    .filter(i => i.loading !== 'lazy' && !(i.complete && i.naturalWidth)).map(i => i.src),
  links: [...document.querySelectorAll('a[href]')].map(a => a.href),
  ids: [...document.querySelectorAll('[id]')].map(e => e.id),
  requests: performance.getEntriesByType('resource').map(r => r.name)};
"""


class Quiet(SimpleHTTPRequestHandler):
    """Serves the site without a word."""

    def log_message(self, *args) -> None:
        """Say nothing."""


def serve(site: Path) -> str:
    """Serve a folder on this machine; its address."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(site)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}/"


def browser():
    """Chromium without a window that keeps a log of its console."""
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or shutil.which("google-chrome") or ""
    for argument in (
        "--headless=new",
        "--no-sandbox",
        "--disable-dev-shm-usage",
        "--hide-scrollbars",
    ):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(
        options=options, service=webdriver.ChromeService(shutil.which("chromedriver"))
    )


def visit(driver, address: str, picture: Callable[[str], Path | None]) -> dict[str, dict]:
    """Open a page once, and ask it in every size and scheme."""
    driver.get(address)
    found = {}
    for (size, width), scheme in product(SIZES.items(), SCHEMES):
        driver.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": False},
        )
        driver.execute_cdp_cmd(
            "Emulation.setEmulatedMedia",
            {"features": [{"name": "prefers-color-scheme", "value": scheme}]},
        )
        name = f"{size}, {scheme}"
        found[name] = driver.execute_script(ASK)
        found[name]["console"] = [
            entry["message"] for entry in driver.get_log("browser") if entry["level"] == "SEVERE"
        ]
        if (file := picture(name)) is not None:
            file.parent.mkdir(parents=True, exist_ok=True)
            driver.save_screenshot(str(file))
    return found


def complaints(found: dict, host: str) -> list[str]:
    """What is wrong with a page by itself."""
    outside = [r for r in found["requests"] if not r.startswith((host, "data:", "blob:"))]
    return [
        f"{kind}: {', '.join(map(str, what[:4]))}"
        for kind, what in (
            ("stands out", found["overflow"]),
            ("cut off", found["cut"]),
            ("navigation in rows", found["rows"]),
            ("missing picture", found["pictures"]),
            ("external request", outside),
            ("console", found["console"]),
        )
        if what
    ]


def broken_links(
    links: dict[str, list[str]], ids: dict[str, set[str]], host: str, site: Path
) -> list[str]:
    """Links within the site whose file or place does not exist."""
    broken = []
    for page, targets in links.items():
        for target in set(targets):
            if not target.startswith(host):
                continue
            address, place = urldefrag(target)
            path = unquote(urlparse(address).path).lstrip("/")
            path = path + "index.html" if not path or path.endswith("/") else path
            if not (site / path).exists():
                broken.append(f"{page}: broken link {target.removeprefix(host)}")
            elif place and path in ids and unquote(place) not in ids[path]:
                broken.append(f"{page}: no place #{place} on {path}")
    return broken


def main() -> int:
    """Visit all pages; 1 if something is wrong."""
    parser = argparse.ArgumentParser(
        description="Open every page of the site in headless Chromium."
    )
    parser.add_argument("site", type=Path, help="folder of the site, or one page")
    parser.add_argument("--out", type=Path, help="folder for screenshots")
    parser.add_argument("--only", default="", help="pages whose path contains this")
    arguments = parser.parse_args()
    given = arguments.site.resolve()
    site = given.parent if given.is_file() else given
    host = serve(site)
    pages = (
        [given.name]
        if given.is_file()
        else sorted(
            str(p.relative_to(site)) for p in site.rglob("*.html") if "_static" not in p.parts
        )
    )
    wrong: list[str] = []
    links: dict[str, list[str]] = {}
    ids: dict[str, set[str]] = {}
    driver = browser()
    for page in (page for page in pages if arguments.only in page):

        def picture(name: str, page: str = page) -> Path | None:
            return arguments.out and arguments.out / name.replace(", ", "-") / (
                page.replace("/", "_") + ".png"
            )

        for name, found in visit(driver, urljoin(host, page), picture).items():
            wrong += [f"{page} ({name}): {text}" for text in complaints(found, host)]
            links[page], ids[page] = found["links"], set(found["ids"])
    driver.quit()
    wrong += broken_links(links, ids, host, site)
    print("\n".join(wrong))
    print(json.dumps({"pages": len(links), "wrong": len(wrong)}))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
