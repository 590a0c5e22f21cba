"""Both theorems of limit analysis checked by other code: scikit-fem's own elements and
quadrature.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from skfem import (
    Basis,
    ElementTriDG,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    FacetBasis,
    InteriorFacetBasis,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.limit_analysis import Bounds


class Ground(NamedTuple):
    """What is to be proven: strengths and weights by subdomain, supports and tractions by boundary.

    Attributes
    ----------
    soils
        Mohr-Coulomb materials.
    body
        Body force (b_x, b_y) by subdomain.
    held
        Components by boundary, such as {"base": (0, 1), "sides": (0,)}.
    tractions
        By boundary.
    """

    soils: Mapping[str, sc.MohrCoulomb]
    body: Mapping[str, tuple[float, float]]
    held: Mapping[str, tuple[int, ...]]
    tractions: Mapping[str, tuple[float, float]]


class Violations(NamedTuple):
    """Of the lower bound: equilibrium inside and across facets, tractions and yield; of the upper:
    supports and flow.

    Equilibrium is relative to the weight of the whole height, yield to the cohesion, flow to the
    largest shear. `dissipation` is that of the mechanism over the power of the loads.
    """

    inside: float
    across: float
    boundary: float
    yielding: float
    supports: float
    flow: float
    dissipation: float


def violations(found: Bounds, ground: Ground, multiplier: bool = False) -> Violations:
    """What is wrong with the fields of some bounds, recomputed from nothing but the fields."""
    lower, upper = (found.lower, found.upper) if not multiplier else (1.0, 1.0)
    return Violations(*_stresses(found, ground, lower), *_velocities(found, ground, upper))


def reduced(ground: Ground, mesh: MeshTri, factor: float) -> tuple[ndarray, ndarray, ndarray]:
    """Cohesion, friction angle and tensile strength of every element, divided by a factor."""
    c, phi, tension = np.zeros((3, mesh.nelements))
    for name, soil in ground.soils.items():
        part = mesh.subdomains[name]
        c[part], phi[part] = soil.c / factor, np.arctan(np.tan(np.radians(soil.phi)) / factor)
        tension[part] = np.inf if soil.tension is None else soil.tension / factor
    return c, phi, tension


def body_force(ground: Ground, mesh: MeshTri) -> ndarray:
    """Body force of every element, (2, n)."""
    force = np.zeros((2, mesh.nelements))
    for name, value in ground.body.items():
        force[:, mesh.subdomains[name]] = np.reshape(value, (2, 1))
    return force


def _stresses(found: Bounds, ground: Ground, factor: float) -> tuple[float, float, float, float]:
    mesh, element = found.stress_mesh, ElementTriDG(ElementTriP1())
    cells = Basis(mesh, element, intorder=2)
    fields = []
    for values in found.stress:
        x = cells.zeros()
        x[cells.element_dofs] = values.T
        fields.append(x)
    body = body_force(ground, mesh)
    size = np.abs(body).max() * np.ptp(mesh.p[1]) + max(
        (np.abs(t).max() for t in ground.tractions.values()), default=0
    )
    xx, yy, xy = (cells.interpolate(x).grad for x in fields)
    h = np.sqrt(cells.dx.sum(axis=1))[:, None]
    unbalanced = xx[0] + xy[1] + body[0, :, None], xy[0] + yy[1] + body[1, :, None]
    inside = max(np.abs(part * h).max() for part in unbalanced)
    one, other = (InteriorFacetBasis(mesh, element, side=i, intorder=3) for i in (0, 1))
    jump = _traction(one, fields, one.normals) - _traction(other, fields, one.normals)
    boundary = 0.0
    sides = {name: np.asarray(mesh.boundaries[name]) for name in ground.held}
    supported = {(f, k) for name, which in ground.held.items() for f in sides[name] for k in which}
    given = {
        int(f): np.array(t)
        for name, t in ground.tractions.items()
        for f in np.asarray(mesh.boundaries[name])
    }
    outer = FacetBasis(mesh, element, intorder=3)
    t = _traction(outer, fields, outer.normals)
    for i, f in enumerate(outer.find):
        for k in (0, 1):
            if (f, k) not in supported:
                boundary = max(boundary, np.abs(t[k, i] - given.get(int(f), np.zeros(2))[k]).max())
    c, phi, tension = reduced(ground, mesh, factor)
    s = found.stress
    radius, mean = np.hypot((s[0] - s[1]) / 2, s[2]), (s[0] + s[1]) / 2
    over = radius + mean * np.sin(phi)[:, None] - (c * np.cos(phi))[:, None]
    over = np.maximum(over, (mean + radius) - tension[:, None])
    return (
        inside / size,
        np.abs(jump).max(initial=0) / size,
        boundary / size,
        float((over / c[:, None]).max()),
    )


def _traction(basis, fields: list[ndarray], n: ndarray) -> ndarray:
    xx, yy, xy = (np.asarray(basis.interpolate(x)) for x in fields)
    return np.stack([xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]])


def _velocities(found: Bounds, ground: Ground, factor: float) -> tuple[float, float, float]:
    mesh = found.mesh
    element = ElementVector(ElementTriP2())
    basis = Basis(mesh, element, intorder=8)
    x = basis.zeros()
    x[basis.nodal_dofs] = found.mechanism[:, : mesh.nvertices]
    x[basis.facet_dofs] = found.mechanism[:, mesh.nvertices :]
    held = [
        basis.get_dofs(name).all(f"u^{k + 1}") for name, which in ground.held.items() for k in which
    ]
    supports = float(np.abs(x[np.concatenate(held)]).max() / np.abs(x).max())
    v = basis.interpolate(x)
    exx, eyy, shear = v.grad[0, 0], v.grad[1, 1], v.grad[0, 1] + v.grad[1, 0]
    volume, radius = exx + eyy, np.hypot(exx - eyy, shear)
    c, phi, tension = reduced(ground, mesh, factor)
    flat = (phi == 0) & np.isinf(tension)
    slack = np.where(flat[:, None], -np.abs(volume), volume - np.sin(phi)[:, None] * radius)
    # largest power of the stresses within yield: at the apex, or at the two corners of the cut-off
    with np.errstate(divide="ignore", invalid="ignore"):
        apex = np.where(phi[:, None] > 0, (c / np.tan(phi))[:, None] * volume, c[:, None] * radius)
        p = ((tension - c * np.cos(phi)) / (1 - np.sin(phi)))[
            :, None
        ]  # of the circle that touches both lines
        corner = np.maximum(p * volume + (tension[:, None] - p) * radius, tension[:, None] * volume)
    cut = tension < np.where(phi > 0, c / np.maximum(np.tan(phi), 1e-300), np.inf)
    spent = (np.where(cut[:, None], corner, apex) * basis.dx).sum()
    power = np.einsum("keq,ke,eq->", np.asarray(v), body_force(ground, mesh), basis.dx)
    for name, t in ground.tractions.items():
        side = FacetBasis(mesh, element, facets=mesh.boundaries[name], intorder=4)
        power += np.einsum("kfq,k,fq->", np.asarray(side.interpolate(x)), np.asarray(t), side.dx)
    return supports, float(-slack.min() / radius.max()), float(spent / power)
