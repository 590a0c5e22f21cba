"""Strip of pictures for the README, from the built gallery.

``python docs/strip.py`` after ``sphinx-build``: it writes ``docs/_static/strip.png``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

HERE = Path(__file__).parent
PICTURES = ("from_drawing_003", "slope_with_bracket_002", "tunnel_with_lining_002", "pile_in_space_001")
HEIGHT, GAP = 360, 16


def strip(folder: Path) -> Image.Image:
    """Return the pictures side by side, each of one height."""
    parts = []
    for name in PICTURES:
        picture = Image.open(folder / f"sphx_glr_plot_{name}.png").convert("RGB")
        parts.append(np.asarray(picture.resize((round(picture.width * HEIGHT / picture.height), HEIGHT))))
        parts.append(np.full((HEIGHT, GAP, 3), 255, np.uint8))
    return Image.fromarray(np.hstack(parts[:-1]))


if __name__ == "__main__":
    strip(HERE / "gallery" / "1_short_scripts" / "images").save(HERE / "_static" / "strip.png", optimize=True)
