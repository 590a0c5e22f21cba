"""The page on choices: elements and orders that it names."""

from __future__ import annotations

import re
from pathlib import Path

import skfem
from skfem import Basis, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc

DOCS = Path(__file__).parents[2] / "docs"


def test_elements_and_orders_of_the_guide_are_accepted():
    """The table of the page on choices names an order for elements that are not refused with it."""
    page = DOCS / "guide" / "choices.md"
    pairs = re.findall(r"`(Element\w+)`, `intorder=(\d)`", page.read_text(encoding="utf-8"))
    assert {("ElementQuad2", "4"), ("ElementTriP2", "2")} <= set(pairs)
    for name, order in set(pairs):
        mesh = MeshTri() if "Tri" in name else MeshQuad()
        basis = Basis(mesh.refined(1), ElementVector(getattr(skfem, name)()), intorder=int(order))
        sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))
