"""Strip of pictures for the README, from the built gallery.

``python docs/strip.py`` after ``sphinx-build``: it writes ``docs/_static/strip.png``.
"""

from __future__ import annotations

from pathlib import Path

from PIL import Image

HERE = Path(__file__).parent
PICTURES = (
    "from_drawing_003",
    "slope_with_bracket_002",
    "tunnel_with_lining_002",
    "pile_in_space_001",
)
COLUMNS, WIDTH, HEIGHT, GAP = 2, 680, 420, 20


def strip(gallery: Path) -> Image.Image:
    """Return the pictures in rows, each as large as its place allows."""
    rows = -(-len(PICTURES) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * (WIDTH + GAP) - GAP, rows * (HEIGHT + GAP) - GAP), "white")
    for number, name in enumerate(PICTURES):
        (path,) = gallery.glob(f"*/images/sphx_glr_plot_{name}.png")
        picture = Image.open(path).convert("RGB")
        picture.thumbnail((WIDTH, HEIGHT), Image.Resampling.LANCZOS)
        row, column = divmod(number, COLUMNS)
        left, top = column * (WIDTH + GAP), row * (HEIGHT + GAP)
        sheet.paste(
            picture, (left + (WIDTH - picture.width) // 2, top + (HEIGHT - picture.height) // 2)
        )
    return sheet


if __name__ == "__main__":
    strip(HERE / "gallery").save(HERE / "_static" / "strip.png", optimize=True)
