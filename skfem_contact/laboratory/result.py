"""Result of an element test: histories of stress and strain, their tables and diagrams."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import ndarray

from ..arrays import max_abs
from ..materials import Material
from ..materials.spectral import mean_and_shear
from .paths import COMPONENTS


@dataclass(frozen=True, eq=False)
class ElementTest:
    """Histories of an element test: the initial state, then one state for each increment.

    Attributes
    ----------
    material : Material
        The material.
    stress, strain : ndarray, shape (n_states, ncomp, n_samples)
        Effective stress, tension positive, and strain with engineering shear.
    internal : ndarray, shape (n_states, n_internal, n_samples)
        Internal variables.
    pore_pressure : ndarray, shape (n_states, n_samples)
        Excess pore pressure, compression positive. Undrained steps add to that before them. Drained
        steps that keep a stress drain against it, as against a back pressure; in other drained
        steps, such as :func:`laboratory.isotropic`, it is zero.
    step : ndarray of int, shape (n_states,)
        Number of the step, -1 for the initial state.
    iterations : ndarray of int, shape (n_states,)
        Newton iterations of the increment.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> clay = sc.Tresca(E=1e4, nu=0.3, c=10.0)
    >>> test = sc.element_test(clay, -100.0, sc.laboratory.triaxial(-0.01, drained=False))
    >>> test.q[-1].round(9), test.pore_pressure[-1].round(6)
    (array([20.]), array([6.666667]))
    """

    material: Material
    stress: ndarray
    strain: ndarray
    internal: ndarray
    pore_pressure: ndarray
    step: ndarray
    iterations: ndarray

    @property
    def p(self) -> ndarray:
        """Mean effective stress, compression positive, (n_states, n_samples)."""
        return -self.stress[:, :3].mean(axis=1)

    @property
    def q(self) -> ndarray:
        """Equivalent shear stress sqrt(3 J2), (n_states, n_samples)."""
        _, shear = mean_and_shear(self.stress.swapaxes(0, 1))
        return np.sqrt(3.0) * shear

    @property
    def volume(self) -> ndarray:
        """Volume strain, negative in compression, (n_states, n_samples)."""
        return self.strain[:, :3].sum(axis=1)

    @property
    def axial(self) -> ndarray:
        """Axial strain yy, negative in compression, (n_states, n_samples)."""
        return self.strain[:, 1]

    def variable(self, name: str) -> ndarray | None:
        """Return an internal variable by its name, (n_states, n_samples), or None.

        Parameters
        ----------
        name
            Name that the material declares.
        """
        return self.material.variable(name, self.internal.swapaxes(0, 1))

    def to_frame(self) -> Any:
        """Return a pandas data frame with a row for each state of each sample."""
        try:
            import pandas
        except ImportError as error:
            raise ImportError("to_frame needs pandas: pip install pandas") from error

        # collect all columns, (n_states, n_samples) each
        states, ncomp, samples = self.stress.shape
        columns = {name: getattr(self, name) for name in ("p", "q", "volume", "pore_pressure")}
        for i, name in enumerate(COMPONENTS[:ncomp]):
            columns[f"stress {name}"] = self.stress[:, i]
            columns[f"strain {name}"] = self.strain[:, i]
        for i, variable in enumerate(self.material.internal):
            columns[variable.name] = self.internal[:, i]

        # put the states of each sample below each other
        data = {"step": np.tile(self.step, samples)}
        data |= {name: values.T.ravel() for name, values in columns.items()}
        index = pandas.MultiIndex.from_product(
            [range(samples), range(states)], names=["sample", "state"]
        )
        return pandas.DataFrame(data, index=index)

    def plot(self, beside: dict[str, ndarray] | None = None) -> Any:
        """Draw the four standard diagrams of all samples; return the matplotlib figure.

        The diagrams show q over the shear strain, q over p, the volume strain (or the pore
        pressure, where the volume stays) over the shear strain, and the volume strain over p on a
        logarithmic axis.

        Parameters
        ----------
        beside
            Measured columns with the names ``"shear"`` (shear strain), ``"p"``, ``"q"``,
            ``"volume"`` and ``"pore_pressure"``, drawn as points where both columns of a diagram
            exist.
        """
        import matplotlib.pyplot as plt

        labels = {
            "shear": "shear strain",
            "p": "p'",
            "q": "q",
            "volume": "volume strain",
            "pore_pressure": "excess pore pressure",
        }

        # choose pore pressure or volume strain for the third diagram
        least = 1e-3 * max_abs(self.strain)
        undrained = max_abs(self.volume) < least
        third = "volume"
        if undrained:
            third = "pore_pressure"
        diagrams = ("shear", "q"), ("p", "q"), ("shear", third), ("p", "volume")

        # draw computed lines and measured points
        measured = beside or {}
        figure, panels = plt.subplots(2, 2, figsize=(8.0, 6.5), layout="constrained")
        for axes, (x, y) in zip(panels.flat, diagrams, strict=True):
            axes.plot(getattr(self, x), getattr(self, y), linewidth=1.2)
            if x in measured and y in measured:
                axes.plot(measured[x], measured[y], "k.", markersize=4)
            axes.set_xlabel(labels[x])
            axes.set_ylabel(labels[y])
        if self.p.min() > 0:
            axes.set_xscale("log")
        return figure

    @property
    def shear(self) -> ndarray:
        """Equivalent shear strain sqrt(2/3 e : e) of the deviator e, (n_states, n_samples)."""
        strain = self.strain.swapaxes(0, 1).copy()
        strain[3:] /= 2
        _, shear = mean_and_shear(strain)
        return 2.0 / np.sqrt(3.0) * shear
