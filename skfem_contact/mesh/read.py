"""Meshes from the files of other programs, with all their names."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike, fspath
from pathlib import Path
from typing import Literal

from skfem import Mesh

from ..checks import positive
from .build import mesh_of
from .content import Content
from .formats import abaqus, flac, gmsh, kratos, med, nastran, vtk

#: Readers by the ends of names.
_READERS: dict[str, Callable[[str], Content]] = {
    ".msh": gmsh.read,
    ".inp": abaqus.read,
    ".vtu": vtk.read,
    ".vtk": vtk.read,
    ".med": med.read,
    ".mdpa": kratos.read,
    ".f3grid": flac.read,
    ".bdf": nastran.read,
    ".nas": nastran.read,
    ".dat": nastran.read,
}


def load_mesh(
    path: str | PathLike[str],
    *,
    plane: Literal["xy", "xz", "yz"] = "xy",
    factor: float = 1.0,
    split: bool = False,
    name: str | None = None,
) -> Mesh:
    """Load the mesh of a file, plane or in space, of first or second order, with all names.

    Groups of elements become subdomains, groups of their sides become boundaries, and so do groups
    of nodes. Groups of Gmsh without a name are ``"surface 1"`` or ``"curve 3"``, by their numbers.

    Parameters
    ----------
    path
        File of Gmsh (``.msh`` of format 2.2 or 4.1), Abaqus or CalculiX (``.inp``), VTK (``.vtu``,
        ``.vtk``), Salome (``.med``, with h5py installed), Kratos (``.mdpa``), FLAC3D (``.f3grid``)
        or Nastran (``.bdf``, ``.nas``, ``.dat``), also with names that scikit-fem saved.
    plane
        Plane in which a section was drawn; ``"xz"``: the upright coordinate is z.
    factor
        Number by which coordinates are multiplied: 0.001 from mm to m.
    split
        Divide elements into triangles or tetrahedra if they are of several kinds, or of a kind that
        is not supported: wedges and pyramids. Sides conform.
    name
        Name of the mesh in a file of Salome with several.

    Returns
    -------
    Mesh
        ``MeshTri``, ``MeshQuad``, ``MeshTet`` or ``MeshHex``, or ``MeshTri2``, ``MeshQuad2``,
        ``MeshTet2`` or ``MeshHex2``, without the nodes that belong to no element. Quadrilaterals of
        8 and hexahedra of 20 nodes get nodes in the middle, and keep their shape.

    Raises
    ------
    ValueError
        If the file is of no such format, damaged, of another version, or empty, or has elements of
        several or unsupported kinds; at the first use of a boundary, if one has sides that no
        element has.
    ImportError
        If h5py is missing for a file of Salome.

    Warns
    -----
    AnalysisWarning
        Names of points and, in space, of lines are left out.

    Notes
    -----
    **Abaqus, CalculiX**: ``*NSET``, ``*ELSET`` (also ``GENERATE``), ``*SURFACE``, ``*INCLUDE``,
    parts and instances, which are moved; sets of instances also are ``"instance.set"``.
    **Kratos**: sub-model parts, nested ones as ``"outer.inner"``; properties where no part has
    elements.
    **VTK**: data of cells with whole numbers: ones among zeros are the group of that name, other
    values are ``"MaterialIDs 3"``.
    **FLAC3D**: groups of zones and faces; slots with names precede theirs, ``"slot:name"``.
    **Nastran**: properties, by number or by the names of HyperMesh, ANSA, Femap, Patran, Simcenter.
    **Sets of nodes** name the outer sides between their nodes, or inner ones where no outer side is
    among them. A set of all nodes is no boundary.
    **Boundaries** are known by name at once. When one of them is first used, the sides of all are
    found and facets are numbered, which takes longer than the reading of a binary file. Sides that
    no element has are refused then.

    See Also
    --------
    save_mesh : Save a mesh with its names.
    join_bodies : Separate bodies that share the nodes of their interfaces.

    Examples
    --------
    >>> from importlib.resources import files
    >>> mesh = load_mesh(files("skfem_contact") / "data" / "culvert.msh")
    >>> sorted(mesh.subdomains)
    ['culvert', 'soft', 'stiff']
    >>> sorted(mesh.boundaries)
    ['bottom', 'culvert_inner', 'left', 'right', 'skin', 'surface']
    """
    file = fspath(path)
    scale = positive(factor, "factor")
    reader = _READERS.get(Path(file).suffix.lower())
    if reader is None:
        raise ValueError(
            f"path must be the name of a file that ends with {', '.join(_READERS)}, not {file!r}: "
            "export one of these, or convert the file by Gmsh"
        )
    if not Path(file).is_file():
        raise FileNotFoundError(f"there is no file {file}")
    if Path(file).stat().st_size == 0:
        raise ValueError(f"{file} is empty")
    if name is not None and reader is not med.read:
        raise ValueError(f"{file}: name= chooses a mesh of a file of Salome (.med): leave it out")
    try:
        if reader is not med.read:
            content = reader(file)
        else:
            content = med.read(file, name)
        return mesh_of(content, plane, scale, split, file)
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from error
    except (KeyError, IndexError, UnicodeError, OverflowError) as error:  # a damaged file
        raise ValueError(f"{file} is damaged or not complete ({error!r})") from error
    except MemoryError as error:
        raise ValueError(f"{file} needs more memory than there is") from error
