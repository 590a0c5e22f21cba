"""CalculiX on one layer of hexahedra, for examples that compare with it."""

import resource
import subprocess
import tempfile
from pathlib import Path


def faces(mesh, boundary):
    """Return the lines of a surface: faces S3 to S6 are the sides of a quadrilateral."""
    facets = mesh.boundaries[boundary]
    owners = mesh.f2t[0, facets]
    sides = (mesh.t2f[:, owners] == facets).argmax(axis=0)
    return [f"{e + 1}, S{s + 3}" for e, s in zip(owners, sides)]


def rubber(name, E, nu):
    """Return the lines of rubber in the elements of a set.

    The law is ``C10 (I1 - 3) + (J - 1)^2 / D1``, with the first invariant at constant volume.
    """
    bulk = E / (3.0 * (1.0 - 2.0 * nu))
    return [
        f"*MATERIAL, NAME={name}",
        "*HYPERELASTIC, NEO HOOKE",
        f"{E / (4.0 * (1.0 + nu))}, {2.0 / bulk}",
        f"*SOLID SECTION, ELSET={name}, MATERIAL={name}",
    ]


def contact(penalty, mu=0.0):
    """Return the lines of contact of the surfaces SLAVE and MASTER."""
    friction = ["*FRICTION", f"{mu}, {penalty}"] if mu else []
    return [
        *("*SURFACE INTERACTION, NAME=CONTACT", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"),
        f"{penalty}",
        *friction,
        *("*CONTACT PAIR, INTERACTION=CONTACT, TYPE=SURFACE TO SURFACE", "SLAVE, MASTER"),
    ]


def run(name, deck):
    """Run CalculiX; return the folder of the results, and the processor time in seconds."""
    folder = Path(tempfile.mkdtemp())
    (folder / f"{name}.inp").write_text(deck)
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run(["ccx", name], cwd=folder, capture_output=True, check=True)
    return folder, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
