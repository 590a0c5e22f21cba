"""Measured tests: columns of a laboratory's file, and the parameters of a law that fit them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy
from numpy import ndarray

from ..arrays import max_abs
from ..checks import finite, look_up
from ..materials import Material
from .paths import PathStep
from .specimen import element_test

#: Quantities of an element test that a column may hold.
_QUANTITIES = ("axial", "shear", "p", "q", "volume", "pore_pressure")
#: Step of derivatives as a share of the parameters: the tests' tolerance of 1e-10 costs 1e-6 of the
#: slope.
_STEP = 1e-4


def read_csv(
    file: str | Path,
    columns: Mapping[str, str],
    factors: Mapping[str, float] | None = None,
    delimiter: str = ",",
) -> dict[str, ndarray]:
    r"""Read columns of a laboratory's file, whose first line has their names.

    Parameters
    ----------
    file
        Name of the file.
    columns
        Names of the columns by quantity: ``"axial"``, ``"shear"``, ``"p"``, ``"q"``, ``"volume"``,
        ``"pore_pressure"``.
    factors
        Factors by quantity, for units and signs: -0.01 for an axial strain in per cent, positive in
        compression.
    delimiter
        Text between two columns.

    Returns
    -------
    dict
        Values by quantity, which :meth:`ElementTest.plot` draws and :func:`fit` takes.

    Examples
    --------
    >>> import os, tempfile
    >>> import skfem_contact as sc
    >>> file = os.path.join(tempfile.mkdtemp(), "test.csv")
    >>> with open(file, "w") as stream:
    ...     _ = stream.write("strain [%],q [kPa]\n0,0\n1,80\n2,95\n")
    >>> columns = {"axial": "strain [%]", "q": "q [kPa]"}
    >>> sc.laboratory.read_csv(file, columns, factors={"axial": -0.01})
    {'axial': array([-0.  , -0.01, -0.02]), 'q': array([ 0., 80., 95.])}
    """
    # read the head, then the numbers below it
    with open(file, encoding="utf-8-sig") as stream:
        names = [name.strip() for name in stream.readline().split(delimiter)]
        table = np.genfromtxt(stream, delimiter=delimiter, ndmin=2)
    if table.shape[1] != len(names):
        raise ValueError(
            f"{file} has {len(names)} names of columns, but {table.shape[1]} columns: separate "
            "them by another `delimiter` than the decimals"
        )
    factors = factors or {}
    for quantity in (*columns, *factors):
        look_up(quantity, dict.fromkeys(_QUANTITIES), "quantity of a test")

    # convert the columns by their factors
    position = {name: k for k, name in enumerate(names)}
    read = {}
    for quantity, name in columns.items():
        k = look_up(name, position, f"column of {file}")
        values = finite(table[:, k], f"column '{name}' of {file}")
        read[quantity] = values * factors.get(quantity, 1.0)
    return read


@dataclass(frozen=True)
class Measured:
    """Measured test: initial stress and path, as in :func:`element_test`, and columns.

    Attributes
    ----------
    stress : float
        Initial effective stress, tension positive.
    path : PathStep or sequence of PathStep
        Steps of the test.
    columns : dict
        Values by quantity, with the quantity along which they are compared.
    along : str
        Quantity along which curves are compared; it only rises, or only falls, in the whole test.
    """

    stress: float
    path: PathStep | Sequence[PathStep]
    columns: Mapping[str, ndarray]
    along: str = "axial"

    def differences(self, material: Material) -> ndarray:
        """Return computed less measured values, over the largest measured one of each quantity."""
        test = element_test(material, self.stress, self.path)

        # Let the quantity along which curves are compared rise.
        computed = getattr(test, self.along)[:, 0]
        sign = -1.0
        if computed[-1] > computed[0]:
            sign = 1.0
        x = sign * computed
        measured_x = sign * look_up(self.along, self.columns, "column")
        if np.any(np.diff(x) < 0):
            raise ValueError(
                f"'{self.along}' turns back in the test: compare along another quantity"
            )
        beyond = float(measured_x.max() - x[-1])
        if beyond > 1e-6 * abs(x[-1]):
            raise ValueError(
                f"the measured '{self.along}' goes beyond the end of the path by {beyond:.3g}"
            )

        # Compare all other quantities.
        parts = []
        for name, measured in self.columns.items():
            if name != self.along:
                difference = np.interp(measured_x, x, getattr(test, name)[:, 0]) - measured
                largest = max_abs(measured) or 1.0
                parts.append(difference / largest)
        return np.concatenate(parts)


@dataclass(frozen=True)
class Fit:
    """Fitted parameters of a law.

    Attributes
    ----------
    material : Material
        Material with these parameters.
    parameters, errors : dict
        Values by name, and their standard errors from the scatter of the measurements.
    differences : ndarray
        Differences of all tests, each over the largest measured value of its quantity.
    """

    material: Material
    parameters: dict[str, float]
    errors: dict[str, float]
    differences: ndarray


def fit(
    law: Callable[..., Material],
    start: Mapping[str, float],
    tests: Measured | Sequence[Measured],
    limits: Mapping[str, tuple[float, float]] | None = None,
) -> Fit:
    """Fit parameters of a law to one or several measured tests at once, by least squares.

    Parameters
    ----------
    law
        Function of the fitted parameters, by name, that returns the material.
    start
        First values of the parameters, not zero.
    tests
        Measured tests.
    limits
        Smallest and largest values by name; by default a tenth and ten times the first one.

    Raises
    ------
    NotConverged
        Where a material on the way cannot follow a test: choose closer limits.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> strain = -np.linspace(0.0, 0.02, 5)
    >>> columns = {"axial": strain, "q": np.array([0.0, 50.0, 100.0, 120.0, 120.0])}
    >>> test = sc.laboratory.Measured(-100.0, sc.laboratory.triaxial(-0.02), columns)
    >>> fitted = sc.laboratory.fit(lambda E, c: sc.Tresca(E, 0.25, c), {"E": 5e3, "c": 40.0}, test)
    >>> {name: round(value) for name, value in fitted.parameters.items()}
    {'E': 10000, 'c': 60}
    """
    # check names, values and limits
    if isinstance(tests, Measured):
        measured = [tests]
    else:
        measured = list(tests)
    limits = limits or {}
    for name in limits:
        look_up(name, start, "fitted parameter")
    first = np.array(list(start.values()), dtype=float)
    if not len(first) or not first.all() or not measured:
        raise ValueError("a fit needs a test, and first values of its parameters that are not zero")
    ends = [limits.get(name, (0.1 * value, 10.0 * value)) for name, value in start.items()]
    low, high = np.sort(ends, axis=1).T

    def named(values: ndarray) -> dict[str, float]:
        return dict(zip(start, values.tolist()))

    def differences(values: ndarray) -> ndarray:
        material = law(**named(values))
        return np.concatenate([test.differences(material) for test in measured])

    # Minimise the squares of the differences between the limits.
    result = scipy.optimize.least_squares(
        differences,
        first,
        bounds=(low, high),
        x_scale=np.abs(first),
        diff_step=np.full(len(first), _STEP),
    )

    # Estimate the standard errors from the scatter, by the inverse of J^T J.
    free = max(len(result.fun) - len(first), 1)
    J = np.asarray(result.jac, dtype=float)
    covariance = np.linalg.pinv(J.T @ J)
    variance = np.diag(covariance) * (result.fun**2).sum() / free
    parameters = named(result.x)
    return Fit(law(**parameters), parameters, named(np.sqrt(variance)), result.fun)
