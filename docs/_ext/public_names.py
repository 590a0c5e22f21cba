"""Code spans of public names become links: ``sc.run``, ``ContactPair``, ``plot.contour(...)``;
``Basis`` to scikit-fem.

Pages of other projects stand in a table here: the build asks no other machine for an inventory.
"""

from __future__ import annotations

import re

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.transforms.post_transforms import SphinxPostTransform

import skfem_contact
import skfem_contact.plot as plot

#: What may stand around a name: the abbreviations that the pages use, and a call.
SPAN = re.compile(
    r"(?:(sc|skfem_contact|plot|skfem_contact\.plot)\.)?([A-Za-z_]\w*)(\(.*\)|=)?$", re.DOTALL
)
#: Names that are words of their own: they link only where a module or a call stands with them.
WORDS = {
    "run",
    "weight",
    "bodies",
    "traction",
    "tractions",
    "reactions",
    "contour",
    "stages",
    "history",
    "mechanism",
}

_SKFEM = "https://scikit-fem.readthedocs.io/en/latest/api.html#skfem."
#: Names of other projects, by how they are written here.
ELSEWHERE = {
    **{
        name: f"{_SKFEM}assembly.{name}"
        for name in ("Basis", "BilinearForm", "CellBasis", "FacetBasis", "LinearForm")
    },
    **{
        name: f"{_SKFEM}mesh.{name}"
        for name in ("Mesh", "MeshHex", "MeshQuad", "MeshTet", "MeshTri")
    },
    **{name: f"{_SKFEM}utils.{name}" for name in ("condense", "enforce", "solve")},
    "ElementVector": f"{_SKFEM}element.ElementVector",
    "LinearForm.assemble": f"{_SKFEM}assembly.LinearForm.assemble",
    "skfem.Mesh.load": f"{_SKFEM}mesh.Mesh.load",
    "csr_matrix": "https://docs.scipy.org/doc/scipy/reference/generated/scipy.sparse.csr_matrix.html",
    "numpy.bincount": "https://numpy.org/doc/stable/reference/generated/numpy.bincount.html",
}


def target(text: str) -> str | None:
    """The qualified public name that a code span means, if it means one."""
    match = SPAN.match(text)
    if match is None:
        return None
    module, name, rest = match.groups()
    if name in plot.__all__ and module in (None, "plot", "skfem_contact.plot"):
        qualified = f"skfem_contact.plot.{name}"
    elif name in skfem_contact.__all__ and module in (None, "sc", "skfem_contact"):
        qualified = f"skfem_contact.{name}"
    else:
        return None
    return qualified if module or name not in WORDS or (rest and rest.startswith("(")) else None


class LinkNames(SphinxPostTransform):
    """Wrap literals of public names into references, before references are resolved."""

    default_priority = 5

    def run(self, **kwargs) -> None:
        """Do it on one page."""
        inside = (nodes.reference, pending_xref, nodes.title)
        for literal in list(self.document.findall(nodes.literal)):
            text = literal.astext()
            name = target(text)
            parents, node = [], literal.parent
            while node is not None:
                parents.append(node)
                node = node.parent
            if not (name or text in ELSEWHERE) or any(
                isinstance(parent, inside) for parent in parents
            ):
                continue
            link = (
                nodes.reference("", "", refuri=ELSEWHERE[text])
                if name is None
                else pending_xref(
                    "",
                    refdomain="py",
                    reftype="obj",
                    reftarget=name,
                    refexplicit=True,
                    refwarn=False,
                    refdoc=self.env.docname,
                )
            )
            literal.replace_self(link)
            link.append(literal)


def setup(app):
    """Register the extension."""
    app.add_post_transform(LinkNames)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
