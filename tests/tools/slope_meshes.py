"""Slopes on a foundation, in quadratic triangles, with elements that shrink towards the toe."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy import ndarray
from skfem import Basis, ElementTriP2, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc
from skfem_contact.collapse.result import CollapseResult
from tests.tools.helpers import analysis

HEIGHT = 10.0


def slope_mesh(run: float, crest: float, depth: float, beyond: float, n: int) -> MeshTri:
    """Triangles of a slope, 10 high, whose toe is the origin and whose crest is on the left.

    Parameters
    ----------
    run, crest, beyond
        Horizontal lengths of the face, behind it, and before the toe.
    depth
        Of the foundation below the toe; zero for none.
    n
        Elements over the height; the foundation's are of the same size.
    """

    def towards_toe(length: float, power: float) -> ndarray:
        """Distances from the toe."""
        return (
            length * np.linspace(0.0, 1.0, int(np.ceil(length / HEIGHT * n / power)) + 1) ** power
        )

    x, y = -towards_toe(run + crest, 1.2)[::-1], HEIGHT * np.linspace(0.0, 1.0, n + 1) ** 1.3
    if depth > 0.0:
        x = np.append(x, towards_toe(beyond, 1.4)[1:])
        y = np.append(-towards_toe(depth, 1.2)[:0:-1], y)
    grid = MeshQuad.init_tensor(x, y)
    middle = grid.p[:, grid.t].mean(axis=1)
    mesh = grid.restrict(np.flatnonzero((middle[0] < 0) | (middle[1] < 0)))
    x, y = mesh.p
    behind = np.where(
        x < 0, 1.0 + x / (run + crest), (x <= 0) * 1.0
    )  # 0 at the left end, 1 at the face
    face = run * np.clip(y / HEIGHT, 0.0, 1.0)
    return MeshQuad(np.array([x - behind * face, y]), mesh.t).to_meshtri(style="x")


def pieces(*parts: tuple[float, float, float]) -> ndarray:
    """Points from start to end in steps of about a size, piece after piece."""
    lines = [
        np.linspace(start, end, max(1, round((end - start) / size)) + 1)
        for start, end, size in parts
    ]
    return np.concatenate([line[:-1] for line in lines] + [lines[-1][-1:]])


def crossed_below(x: ndarray, y: ndarray, surface: Callable[[ndarray], ndarray]) -> MeshTri:
    """Rectangles cut along both diagonals, below a surface that goes along grid lines and
    diagonals.
    """
    mesh = MeshQuad.init_tensor(x, y).to_meshtri(style="x")
    middle = mesh.p[:, mesh.t].mean(axis=1)
    return mesh.restrict(np.flatnonzero(middle[1] < surface(middle[0])))


def held(basis: Basis) -> ndarray:
    """Dofs of the base, and those that would leave through the vertical sides."""
    x, y = basis.doflocs
    across = np.zeros(basis.N, dtype=bool)
    across[basis.nodal_dofs[0]] = across[basis.facet_dofs[0]] = True
    return np.flatnonzero(
        np.isclose(y, y.min()) | (across & (np.isclose(x, x.min()) | np.isclose(x, x.max())))
    )


def reduced_slope(
    mesh: MeshTri, materials, unit_weight: float = 20.0, **settings
) -> CollapseResult:
    """Strength reduction under the weight."""
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    forms = {"soil": sc.SolidForm(basis, materials)}
    return analysis(
        "strength_reduction",
        forms,
        held(basis),
        sc.weight(basis, unit_weight),
        progress=False,
        **settings,
    )
