"""Make ``docs/_static/report.png``, the picture of a report in the guide, with headless Chromium.

``python docs/report_picture.py`` runs the example of a propped excavation and takes a picture of
the report it writes."""

from __future__ import annotations

import os
import runpy
import tempfile
from pathlib import Path

import matplotlib
from check_pages import browser

DOCS = Path(__file__).parent
EXAMPLE = DOCS.parent / "examples" / "4_pits_and_walls" / "plot_propped_excavation.py"
WIDTH, HEIGHT = 1180, 1500


def main() -> None:
    """Run the example in a folder of its own and take the picture."""
    matplotlib.use("Agg")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        runpy.run_path(str(EXAMPLE), run_name="__main__")
        driver = browser()
        driver.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": WIDTH, "height": HEIGHT, "deviceScaleFactor": 1, "mobile": False},
        )
        driver.get((Path(folder) / "propped_excavation.html").as_uri())
        driver.save_screenshot(str(DOCS / "_static" / "report.png"))
        driver.quit()
        os.chdir(DOCS)


if __name__ == "__main__":
    main()
