"""Settings of a stage in time: the step, the scheme, masses and damping."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy import ndarray

from ..checks import finite, is_number

#: Damping ratio above which per cent were probably meant.
_MOST = 0.5


@dataclass(frozen=True)
class Rayleigh:
    r"""Rayleigh damping with one damping ratio at two frequencies.

    .. math:: C = \alpha M + \beta K, \qquad
       \alpha = \frac{2 \zeta \omega_1 \omega_2}{\omega_1 + \omega_2}, \quad
       \beta = \frac{2 \zeta}{\omega_1 + \omega_2}

    K is the elastic stiffness. Between the two frequencies the ratio is smaller, outside of them
    it is larger. The part with M brakes rigid motions too, such as slip on a contact surface:
    where bodies slide far, a first frequency near zero leaves the part with K.

    Parameters
    ----------
    ratio
        Share of critical damping, such as 0.02 for 2 %.
    f
        The two frequencies in cycles per time (Hz), the lower one first.

    Raises
    ------
    ValueError
        A ratio outside of 0 to 0.5, or frequencies that are not positive or not in order.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> damping = sc.Rayleigh(.05, f=(1., 5.))
    >>> round(damping.alpha, 4), round(damping.beta, 6)
    (0.5236, 0.002653)
    >>> round(damping.at(1.), 12), round(damping.at(5.), 12)
    (0.05, 0.05)
    """

    ratio: float
    f: Sequence[float]

    def __post_init__(self) -> None:
        if not is_number(self.ratio, -1e-300, _MOST):
            raise ValueError(
                f"the damping ratio must be between 0 and {_MOST}, not {self.ratio!r}: 0.05 for 5 %"
            )
        f = finite(self.f, "f")
        if f.shape != (2,) or not 0.0 < f[0] < f[1]:
            raise ValueError(
                f"f must be two positive frequencies, the lower one first, not {self.f!r}"
            )

    @property
    def alpha(self) -> float:
        """Factor of the mass matrix, per time."""
        first, second = 2.0 * np.pi * np.asarray(self.f, float)
        return float(2.0 * self.ratio * first * second / (first + second))

    @property
    def beta(self) -> float:
        """Factor of the stiffness matrix, a time."""
        first, second = 2.0 * np.pi * np.asarray(self.f, float)
        return float(2.0 * self.ratio / (first + second))

    def at(self, frequency: float) -> float:
        """Return the damping ratio at a frequency (Hz)."""
        omega = 2.0 * np.pi * frequency
        return 0.5 * (self.alpha / omega + self.beta * omega)


@dataclass(frozen=True)
class Dynamic:
    """Inertia in a stage, integrated by the generalised-alpha method.

    Parameters
    ----------
    step
        Length of a step in time; the last digit follows from the duration of the stage, which has a
        whole number of steps. Steps that find no equilibrium are cut. Explicit steps are by default
        0.9 of the longest stable one, which the mesh determines; longer ones are refused.
    rho_inf
        Share of the amplitude of the highest frequencies that a step leaves, 0 to 1. At 1, the
        trapezoidal rule of Newmark, nothing is damped. All values are of second order.
    mass
        ``"lumped"``: a diagonal matrix, by scaled diagonals of the consistent one, which is right
        for elements of second order too; or ``"consistent"``.
    contact_mass
        ``"moved"``: nodes of contact surfaces have no mass of their own, their neighbours inside
        the body have it. Contact then neither chatters nor gains energy. ``"kept"``: they keep it,
        as in explicit steps always.
    damping
        Rayleigh damping of all solids, or by the names of regions or of solids.
    velocity
        Velocities at the start, (N,); by default the last ones, zero after a stage without
        inertia.
    points
        Nodes whose motion is recorded in every step, see :meth:`StageResult.history`: coordinates
        (n, dim) or (dim,) in the mesh; nodes of a beam, :meth:`Beam.at`; or a list of both.
    explicit
        True for central differences with lumped masses: many short steps without any system of
        equations, for impact and waves in large meshes. Contact acts by penalties.
    tolerance
        Error of a step, as a share of the largest displacement of the stage, such as 1e-3. Steps
        are then parts of `step`, 1/2, 1/4, ...: shorter where they err by more, and while contact
        closes; longer again afterwards. By default all steps have the same length.

    Raises
    ------
    ValueError
        A step that is not positive, ``rho_inf`` outside of 0 to 1, unknown words.

    Notes
    -----
    Chung and Hulbert (1993), J. Appl. Mech. 60, 371; masses of contact nodes: Khenous, Laborde and
    Renard (2008), Eur. J. Mech. A 27, 918; scaled diagonals: Hinton, Rock and Zienkiewicz (1976),
    Earthq. Eng. Struct. Dyn. 4, 245.

    Examples
    --------
    A column on which a load is put suddenly swings to twice its static displacement:

    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> column = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.), unit_weight=20.)
    >>> fixed = [basis.get_dofs("bottom").all(), basis.get_dofs().all("u^1")]
    >>> model = sc.Model({"column": column}, fixed, gravity_acceleration=10.)
    >>> period = 2. * np.pi / np.sqrt(1e4 / 1.)                # half of the mass is at the top
    >>> load = sc.traction(basis, "top", (0., -3.))
    >>> top = basis.get_dofs("top").all("u^2")[0]
    >>> swing = sc.Stage("swing", load, duration=period / 2., dynamic=sc.Dynamic(period / 100.))
    >>> result = model.run([sc.Stage("weight"), swing])
    >>> moved = result["swing"].x[top] - result["weight"].x[top]
    >>> round(float(moved / (-3. / 1e4)), 3)
    2.0
    """

    step: float | None = None
    rho_inf: float = 0.8
    mass: Literal["lumped", "consistent"] = "lumped"
    contact_mass: Literal["moved", "kept"] | None = None
    damping: Rayleigh | Mapping[str, Rayleigh] | None = None
    velocity: ndarray | None = None
    points: Any = ()
    explicit: bool = False
    tolerance: float | None = None

    def __post_init__(self) -> None:
        self._check_step()
        self._check_masses()

    def _check_step(self) -> None:
        """Raise an error if the scheme, its step or its tolerance is wrong."""
        if self.step is None and not self.explicit:
            raise ValueError("give the step in time; only explicit steps have a default")
        if self.step is not None and not is_number(self.step, 0.0, np.inf):
            raise ValueError(f"the step in time must be positive, not {self.step!r}")
        if self.rho_inf not in (0.0, 1.0) and not is_number(self.rho_inf, 0.0, 1.0):
            raise ValueError(f"rho_inf must be between 0 and 1, not {self.rho_inf!r}")
        if self.tolerance is not None and not is_number(self.tolerance, 0.0, 0.1):
            raise ValueError(
                f"the tolerance of a step must be a share between 0 and 0.1, not "
                f"{self.tolerance!r}: 0.001 errs by 0.1 % of the largest displacement"
            )
        if self.tolerance is not None and self.explicit:
            raise ValueError("explicit steps have one length: give no tolerance")

    def _check_masses(self) -> None:
        """Raise an error if no such masses exist."""
        if self.mass not in ("lumped", "consistent"):
            raise ValueError(f"mass must be 'lumped' or 'consistent', not {self.mass!r}")
        if self.contact_mass not in (None, "moved", "kept"):
            raise ValueError(f"contact_mass must be 'moved' or 'kept', not {self.contact_mass!r}")
        if self.explicit and (self.mass == "consistent" or self.contact_mass == "moved"):
            raise ValueError(
                "explicit steps have lumped masses at all nodes: give neither mass='consistent' "
                "nor contact_mass='moved'"
            )

    @property
    def moves_contact_mass(self) -> bool:
        """True if contact nodes have no mass."""
        return self.contact_mass != "kept" and not self.explicit

    def steps(self, duration: float, longest: float | None = None) -> int:
        """Return the number of steps of a stage, none of them longer than the longest one."""
        step = self.step if self.step is not None else longest
        assert step is not None
        return max(1, int(np.ceil(duration / step * (1.0 - 1e-9))))
