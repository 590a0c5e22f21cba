"""Columns of ground at the sides of a model, which do not feel it: the free field."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import bmat, csr_matrix
from skfem import Basis, ElementQuad1, ElementQuad2, ElementVector, MeshQuad
from typing_extensions import override

from ..checks import facets_of, format_point
from ..forms.base import Form, Response, States
from ..forms.roles import Absorbing, Couples, Staged
from ..forms.solid import SolidForm, SolidState
from ..layout import Field, dofs_at, facet_corners
from ..sparse import scattered, within
from .boundaries import Bedrock, Masses, ViscousBoundary

#: Coordinates of a vertical side and of its layers differ by less than this share of its height.
_STRAIGHT = 1e-6


@dataclass(frozen=True)
class FreeFieldState:
    """State of a column of the free field.

    Attributes
    ----------
    strain, stress, internal
        As of a solid.
    before : ndarray, shape (n,)
        Internal forces at the nodes of the column at rest, which count from there.
    fresh
        1 before the first stage with inertia, then 0.
    """

    strain: ndarray
    stress: ndarray
    internal: ndarray
    before: ndarray
    fresh: ndarray

    @property
    def solid(self) -> SolidState:
        """State of the elements."""
        return SolidState(self.strain, self.stress, self.internal)


class FreeField(Form, Couples, Staged, Absorbing):
    """Free field along a vertical side of plane ground, in stages with ``dynamic``.

    A column of the elements at the side, whose nodes of one level move together, shakes with the
    base. It has the materials and the stresses of these elements and yields like them. Dashpots
    between the column and the side take up waves that leave the model, and the stresses of the
    column act on the side: without anything else in the model, the ground moves like the column.

    Parameters
    ----------
    solid
        Solid form of the ground, with a unit weight.
    boundary
        Name of a vertical side. Its supports are taken away in a stage with ``dynamic``.
    rock
        Rock below the column, as of the :class:`ViscousBoundary` at the base of the model; by
        default the base holds the column, too.

    Raises
    ------
    ValueError
        A side that is not vertical or lies inside, or ground that is not plane.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()))
    >>> ground = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=.3), unit_weight=20.)
    >>> sc.FreeField(ground, "left")
    <FreeField at 'left', 4 elements>
    """

    def __init__(self, solid: SolidForm, boundary: str, rock: Bedrock | None = None) -> None:
        if solid.coordinates != "plane":
            raise ValueError(f"a free field is of plane ground, not {solid.coordinates}")
        self._dashpots = ViscousBoundary(solid, boundary)
        self.absorbs_at = self._dashpots.absorbs_at
        self._solid = solid
        self._boundary = boundary
        self._rock = rock
        self.of_rock = rock is not None
        self.joins = np.zeros(0, int)
        self._moving = False
        self._name = ""
        self._build(solid.basis)
        changing = self._column.changing
        if changing is None or len(changing):
            self.changing = None
        else:
            self.changing = np.zeros(0, int)

    def __repr__(self) -> str:
        return f"<FreeField at '{self._boundary}', {self._column.basis.nelems} elements>"

    def _build(self, basis: Any) -> None:
        """Build the column, and its matrices to levels and to the side."""
        # Find the layers of the side
        mesh = basis.mesh
        facets = facets_of(mesh, self._boundary)
        ends = facet_corners(mesh, facets)  # (2, 2, n_facets)
        x, height = self._upright(ends)
        order = np.argsort(ends[1].mean(axis=0))
        levels = np.append(ends[1].min(axis=0)[order], ends[1].max())
        self._outwards = 1.0 if x > mesh.p[0].mean() else -1.0
        self._width = height / len(facets)
        position = np.full(mesh.nelements, -1)
        position[self._solid.elements] = np.arange(len(self._solid.elements))
        self._build_column(position[mesh.f2t[0, facets[order]]], levels)

        # Dofs of the levels, and of the nodes at the side
        column = self._column.basis
        x_dofs, y_dofs = column.doflocs
        relative = np.round((y_dofs - levels[0]) / height, 9)
        heights, level = np.unique(relative, return_inverse=True)
        n = column.N
        dofs = np.arange(n)
        own = 2 * level + dofs % 2
        m = 2 * len(heights)
        self._tied = csr_matrix((np.ones(n), (dofs, own)), shape=(n, m))
        # half the difference of the forces on both sides is the traction
        off_middle = x_dofs / self._width - 0.5
        sides = np.sign(off_middle).round()
        sides[np.abs(off_middle) < 0.25] = 0.0
        self._traction = csr_matrix((0.5 * sides, (own, dofs)), shape=(m, n))
        y = levels[0] + height * heights
        points = np.column_stack((np.full(len(heights), x), y))
        self._side = dofs_at(basis, points).ravel()
        self._bottom = np.array([0, 1])
        self.field = Field("free field", np.repeat(points, 2, axis=0).T)
        self.fields = (self.field,)
        self._own = np.zeros(0, int)
        self._dofs = self._side

    def _upright(self, ends: ndarray) -> tuple[float, float]:
        """Return coordinate and height of a vertical side, given the ends of its facets."""
        height = float(np.ptp(ends[1]))
        x = float(ends[0].mean())
        offset = np.abs(ends[0] - x)
        if offset.max() > _STRAIGHT * height or height == 0.0:
            worst = offset.max(axis=0).argmax()
            raise ValueError(
                f"the side '{self._boundary}' of a free field is not vertical, at "
                f"{format_point(ends[:, 0, worst])}"
            )
        return x, height

    def _build_column(self, at_side: ndarray, levels: ndarray) -> None:
        """Build a column of as many elements as are at the side, with their materials."""
        strip = MeshQuad.init_tensor(np.array([0.0, self._width]), levels)
        middles = strip.p[1][strip.t].mean(axis=0)
        beside = at_side[np.argsort(np.argsort(middles))]
        solid = self._solid
        parts: dict[str, ndarray] = {}
        materials = {}
        weight = {}
        for region in solid.regions:
            inside = np.zeros(len(solid.elements), bool)
            inside[region.elements] = True
            part = np.flatnonzero(inside[beside])
            if len(part):
                parts[region.name] = part
                materials[region.name] = region.material
                weight[region.name] = float(solid.unit_weights[beside[part]].mean())
        element = ElementQuad1()
        intorder = 2
        if solid.basis.Nbfun > 2 * len(solid.basis.mesh.t):  # of second order
            element = ElementQuad2()
            intorder = 4
        basis = Basis(strip.with_subdomains(parts), ElementVector(element), intorder=intorder)
        self._column = SolidForm(basis, materials, strain=solid.strain, unit_weight=weight)
        self._beside = beside[self._column.elements]

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> FreeField:
        new = copy(self)
        new._own = numbers[self.field]
        new._dofs = np.concatenate((self._side, new._own))
        return new

    @override
    def completed(self, forms: Mapping[str, Any]) -> FreeField:
        new = copy(self)
        for name, form in forms.items():
            if getattr(form, "basis", None) is self._solid.basis:
                new._name = name
                return new
        raise ValueError("the solid of its ground is not in the model")

    @override
    def in_motion(self) -> FreeField:
        new = copy(self)
        new._moving = True
        return new

    @override
    def supported(self, fixed: ndarray) -> tuple[FreeField, ndarray]:
        if not self._moving:
            return self, self._own
        if self._rock is None:
            return self, self._own[self._bottom]
        return self, np.zeros(0, int)

    @override
    def initial_state(self, x: ndarray | None = None) -> FreeFieldState:
        first = self._column.initial_state()
        before = np.zeros(self._column.basis.N)
        return FreeFieldState(first.strain, first.stress, first.internal, before, np.ones(1))

    @override
    def begun(self, states: States, state: FreeFieldState) -> FreeFieldState:
        if not state.fresh[0]:
            return state
        # the means of the stresses and internal variables of the elements at the side
        ground = states[self._name]
        at = self._beside
        stress = state.stress.copy()
        stress[:] = ground.stress[:, at].mean(axis=2)[:, :, None]
        internal = state.internal.copy()
        internal[:] = ground.internal[: len(internal), at].mean(axis=2)[:, :, None]
        new = replace(state, stress=stress, internal=internal, fresh=np.zeros(1))
        rest = self._column.assemble(np.zeros(self._column.basis.N), new.solid)
        return replace(new, before=rest.force)

    @override
    def assemble(self, x: ndarray, state: FreeFieldState) -> Response:
        # The column moves with the side; its change of stress acts on the ground.
        column = self._column.assemble(self._tied @ x[self._own], state.solid)
        change = column.force - state.before
        on_side = -self._outwards * (self._traction @ change)
        along = self._tied.T @ change

        def new() -> FreeFieldState:
            found = column.state
            return replace(state, strain=found.strain, stress=found.stress, internal=found.internal)

        return Response(
            np.concatenate((on_side, along)),
            new,
            lambda: self._coupled(column.stiffness),
            round_off=column.round_off,
            dofs=self._dofs,
        )

    def _coupled(self, K: csr_matrix) -> csr_matrix:
        """Return the matrix of a matrix of the column, among the dofs of side and column."""
        tied = K @ self._tied
        m = self._tied.shape[1]
        blocks = [
            [csr_matrix((m, m)), -self._outwards * (self._traction @ tied)],
            [None, self._tied.T @ tied],
        ]
        return csr_matrix(bmat(blocks))

    @override
    def matrices(self, given: Masses) -> tuple[csr_matrix, csr_matrix]:
        # masses of the column, and its damping, whose stresses act on the side as well
        column = self._column
        m = self._tied.shape[1]
        alpha = {name: each.alpha for name, each in given.damping.items()}
        beta = {name: each.beta for name, each in given.damping.items()}
        mass = column.weight_matrix(given.consistent)
        drag = column.weight_matrix(given.consistent, alpha)
        assert mass is not None and drag is not None
        M = self._tied.T @ mass @ self._tied / given.acceleration
        C = csr_matrix(self._coupled(column.scaled_stiffness(beta)))
        local = self._tied.T @ drag @ self._tied / given.acceleration
        if self._rock is not None:
            density = self._rock.unit_weight / given.acceleration * self._width
            speeds = np.array([self._rock.vs, self._rock.vp])
            base = np.zeros(m)
            base[self._bottom] = density * speeds
            diagonal = np.arange(m)
            local = local + csr_matrix((base, (diagonal, diagonal)))

        # dashpots between side and column
        _, dashpots = self._dashpots.matrices(given)
        D = within(dashpots, self._side)
        C = C + bmat([[D, -D], [None, local]])
        whole = bmat([[csr_matrix((m, m)), None], [None, M]])
        return (
            scattered(csr_matrix(whole), self._dofs, given.size),
            scattered(csr_matrix(C), self._dofs, given.size),
        )
