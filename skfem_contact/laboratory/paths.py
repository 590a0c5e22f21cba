"""Steps of laboratory tests: one linear condition on stress or strain for each component.

A round sample stays round by equal strains, not by equal stresses: on an edge of Mohr-Coulomb's
pyramid two equal stresses are one condition. For the same reason shear strains are prescribed
unless another condition is.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..checks import finite, look_up

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")
_UNIT = dict(zip(COMPONENTS, np.eye(6), strict=True))
_SUM = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
_STRESSES = _UNIT | {"p": -_SUM / 3, "q": _UNIT["xx"] - _UNIT["yy"]}
_STRAINS = _UNIT | {"volume": _SUM, "xx-zz": _UNIT["xx"] - _UNIT["zz"]}


@dataclass(frozen=True, eq=False)
class PathStep:
    """PathStep of an element test: one condition for each component.

    Shear components without a condition keep their strain. Values are numbers, or one number a
    sample.

    Parameters
    ----------
    stress
        Effective stresses at the end of the step, tension positive: ``"xx"``, ``"yy"`` (axial),
        ``"zz"``, ``"xy"``, ``"yz"``, ``"zx"``, ``"p"`` (mean stress, compression positive) or
        ``"q"`` (xx - yy). None keeps the value.
    strain
        Changes of strains in the step: the same components, with engineering shear, ``"volume"`` or
        ``"xx-zz"``.
    increments
        Number of increments.
    duration
        Time, which only time-dependent materials need.
    total
        Component of the normal stress that stays in total stress where the water cannot leave: its
        effective stress gives the pore pressure.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> plane_strain = sc.laboratory.PathStep(stress={"xx": None}, strain={"yy": -0.01, "zz": 0.0})
    >>> test = sc.element_test(sc.LinearElastic(E=100.0, nu=0.25), -10.0, plane_strain)
    >>> test.stress[-1].ravel().round(9)
    array([-10.        , -11.06666667, -10.26666667,   0.        ])
    """

    stress: Mapping[str, ArrayLike | None] = field(default_factory=dict)
    strain: Mapping[str, ArrayLike] = field(default_factory=dict)
    increments: int = 100
    duration: float = 0.0
    total: str | None = None

    def __post_init__(self) -> None:
        if self.increments < 1 or self.duration < 0:
            raise ValueError(
                f"increments must be positive and duration not negative, got {self.increments} and "
                f"{self.duration}"
            )
        for names, known in ((self.stress, _STRESSES), (self.strain, _STRAINS)):
            for name in names:
                look_up(name, known, "component of a step")
        if self.total is not None:
            look_up(self.total, dict.fromkeys(COMPONENTS[:3]), "normal stress")

    @property
    def keeps_total(self) -> bool:
        """True where a total normal stress stays, as a cell pressure, and water of steps before."""
        normal = [name for name in COMPONENTS[:3] if name in self.stress]
        return self.total is not None or any(self.stress[name] is None for name in normal)

    def conditions(self, ncomp: int) -> tuple[ndarray, ndarray]:
        """Return the rows of stresses and of strains, (n, ncomp) each, ncomp in all."""
        # keep shear strains without a condition
        given = [*self.stress, *self.strain]
        kept = [name for name in COMPONENTS[3:ncomp] if name not in given]
        stresses = _rows(_STRESSES, self.stress)
        strains = _rows(_STRAINS, [*self.strain, *kept])

        # check the number of conditions
        rows = np.concatenate((stresses, strains))
        if len(rows) != ncomp or rows[:, ncomp:].any():
            raise ValueError(
                f"a step of {ncomp} components needs {ncomp} conditions, of which shear strains "
                f"are kept by themselves; given are {given}"
            )
        return stresses[:, :ncomp], strains[:, :ncomp]

    def targets(self, stress: ndarray, strain: ndarray) -> tuple[ndarray, ndarray]:
        """Return the values of the conditions at the end of the step, (n, n_samples) each."""
        S, E = self.conditions(len(stress))
        stresses = S @ stress
        strains = E @ strain
        for row, value in zip(stresses, self.stress.values()):
            if value is not None:
                row[...] = finite(value, "stress of a step")
        for row, value in zip(strains, self.strain.values()):
            row += finite(value, "strain of a step")
        return stresses, strains


def _rows(known: Mapping[str, ndarray], names: Iterable[str]) -> ndarray:
    """Return the rows of some components, (n, 6)."""
    return np.reshape([known[name] for name in names], (-1, 6))


def isotropic(stress: ArrayLike, increments: int = 100) -> PathStep:
    """Return a step to an isotropic effective stress, tension positive.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> path = sc.laboratory.isotropic(-2.0)
    >>> test = sc.element_test(sc.LinearElastic(E=30.0, nu=0.0), -1.0, path)
    >>> test.volume[-1].round(9)
    array([-0.1])
    """
    return PathStep(dict.fromkeys(COMPONENTS[:3], stress), {}, increments)


def oedometer(
    stress: ArrayLike | None = None, strain: ArrayLike | None = None, increments: int = 100
) -> PathStep:
    """Return a step of axial stress (yy), or change of axial strain, without lateral strain.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> path = sc.laboratory.oedometer(stress=-20.0)
    >>> test = sc.element_test(sc.LinearElastic(E=100.0, nu=0.0), -10.0, path)
    >>> test.axial[-1].round(9)
    array([-0.1])
    """
    return _axial(stress, strain, {}, {"xx": 0.0, "zz": 0.0}, increments)


def triaxial(
    strain: ArrayLike | None = None,
    stress: ArrayLike | None = None,
    drained: bool = True,
    increments: int = 100,
) -> PathStep:
    """Return a step of axial strain (yy), or axial effective stress, at constant cell pressure.

    The strain is a change, the stress a value at the end. Undrained, the volume is constant, and
    the pore pressure follows from the cell pressure. A material :class:`~skfem_contact.Undrained`
    has total stresses and takes ``drained=True``.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sand = sc.MohrCoulomb(E=2e4, nu=0.25, c=0.0, phi=30.0)
    >>> sc.element_test(sand, -100.0, sc.laboratory.triaxial(-0.05)).q[-1].round(6)
    array([200.])
    """
    if drained:
        return _axial(stress, strain, {"xx": None}, {"xx-zz": 0.0}, increments)
    return _axial(stress, strain, {}, {"xx-zz": 0.0, "volume": 0.0}, increments, "xx")


def simple_shear(gamma: ArrayLike, drained: bool = True, increments: int = 100) -> PathStep:
    """Return a step of engineering shear strain (xy) at constant stress yy, or constant volume.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> path = sc.laboratory.simple_shear(0.01)
    >>> test = sc.element_test(sc.LinearElastic(E=100.0, nu=0.25), -10.0, path)
    >>> test.stress[-1, 3].round(9)
    array([0.4])
    """
    strain = {"xx": 0.0, "zz": 0.0, "xy": gamma}
    if drained:
        return PathStep({"yy": None}, strain, increments)
    return PathStep({}, strain | {"yy": 0.0}, increments, total="yy")


def _axial(
    stress: ArrayLike | None,
    strain: ArrayLike | None,
    stresses: Mapping[str, ArrayLike | None],
    strains: Mapping[str, ArrayLike],
    increments: int,
    total: str | None = None,
) -> PathStep:
    """Return a step that is driven by its axial stress or strain."""
    if (stress is None) == (strain is None):
        raise ValueError("the axial direction needs either a stress or a strain")
    if strain is not None:
        return PathStep(stresses, {"yy": strain, **strains}, increments, total=total)
    return PathStep({"yy": stress, **stresses}, strains, increments, total=total)
