"""Node-to-segment contact without bias: each body is slave once."""
from __future__ import annotations

from skfem import CellBasis

from .laws import InterfaceLaw
from .pair import ContactPair


def two_pass(basis: CellBasis, a: str, b: str, law: InterfaceLaw, **options: object) -> dict[str, ContactPair]:
    """Two pairs with the roles swapped, each with half of the contact work: node-to-segment without bias.

    Parameters
    ----------
    basis, law
        As for :class:`ContactPair`.
    a, b
        Names of the boundaries.
    options
        Further arguments of :class:`ContactPair`; ``quadrature="nodal"`` unless it is given.

    Returns
    -------
    dict
        The two forms, named ``"a on b"``.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> block = MeshQuad().refined(1).with_defaults()
    >>> mesh = sc.join_bodies({"lower": block, "upper": block.translated((0., 1.))})
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> list(sc.two_pass(basis, "upper:bottom", "lower:top", sc.Coulomb(mu=.3)))
    ['upper:bottom on lower:top', 'lower:top on upper:bottom']
    """
    options = {"quadrature": "nodal", **options}
    return {f"{slave} on {master}": ContactPair(basis, slave, master, law, share=0.5, **options)  # type: ignore[arg-type]
            for slave, master in ((a, b), (b, a))}
