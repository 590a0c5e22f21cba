"""Contact of a form with dofs of its own, which the model numbers, as slave and as master."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_matrix

import skfem_contact as sc
from tests.tools.helpers import grid, vector_basis

LOW = grid("Q1", np.linspace(-0.5, 1.5, 9), np.linspace(-1, 0, 5))
UP = grid("Q1", np.linspace(0, 1, 6), np.linspace(0, 0.6, 4))
STEEL, LAW = sc.LinearElastic(E=1e3, nu=0.3), sc.Coulomb(0.3)


class Block(sc.Form):
    """An elastic block in dofs that are not those of the mesh, with a load on its top."""

    def __init__(self) -> None:
        basis = vector_basis(UP, "Q1", intorder=2)
        self.K, self.load = (
            csr_matrix(sc.SolidForm(basis, STEEL).elastic_stiffness),
            top_load(basis),
        )
        self.fields, self.numbers = (sc.Field("block", basis.doflocs),), np.zeros(0, int)
        nodes = np.flatnonzero(UP.p[1] == 0.0)
        nodes = nodes[np.argsort(-UP.p[0, nodes])]
        cells = np.column_stack((np.arange(5), np.arange(1, 6)))
        self.surface = sc.Surface.from_cells(
            UP.p[:, nodes].T, (self.fields[0], basis.nodal_dofs[:, nodes].T), cells
        )

    def numbered(self, numbers):
        self.numbers = np.asarray(numbers[self.fields[0]])
        return self

    def assemble(self, x, state):
        return sc.Response(
            self.K @ x[self.numbers] - self.load, lambda: state, lambda: self.K, dofs=self.numbers
        )


def top_load(basis) -> np.ndarray:
    load = basis.zeros()
    load[basis.nodal_dofs[1, np.isclose(basis.mesh.p[1], 0.6)]] = -2.0
    return load


@pytest.mark.parametrize("swapped", [False, True])
def test_block_with_dofs_of_its_own(swapped: bool) -> None:
    """[X] Pressure and settlement are those of two bodies of one mesh, whichever is the slave."""
    both = vector_basis(sc.join_bodies({"low": LOW, "up": UP}), "Q1", intorder=2)
    names = ["low:top", "up:bottom"] if swapped else ["up:bottom", "low:top"]
    forms = {
        "solids": sc.SolidForm(both, STEEL),
        "joint": sc.ContactPair(both, *names, LAW, penalty=2e4),
    }
    wanted = sc.Model(forms, both.get_dofs("low:bottom").all()).run(
        [sc.Stage("press", top_load(both))]
    )["press"]

    low, block = vector_basis(LOW, "Q1", intorder=2), Block()
    sides = ["top", block.surface] if swapped else [block.surface, "top"]
    forms = {
        "low": sc.SolidForm(low, STEEL),
        "block": block,
        "joint": sc.ContactPair(low, *sides, LAW, penalty=2e4),
    }
    model = sc.Model(forms, low.get_dofs("bottom").all())
    assert model.layout.size == low.N + block.K.shape[0]
    found = model.run([sc.Stage("press", low.zeros())])["press"]
    one, other = (np.sort(stage.tractions("joint").pressure) for stage in (wanted, found))
    np.testing.assert_allclose(other, one, atol=1e-6)
    assert found.x.min() == pytest.approx(wanted.x.min(), rel=1e-8)
    del forms["block"]
    with pytest.raises(
        ValueError, match="'joint' acts on the field 'block', which no form of the model brings"
    ):
        sc.Model(forms, low.get_dofs("bottom").all())
