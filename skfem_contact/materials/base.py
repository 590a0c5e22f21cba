"""Contract of a material, and checks of its parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import Annotated, Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import override

from ..checks import finite
from ..errors import warn

Array = NDArray[np.float64]
Parameter = float | Array
#: Parameter as the user gives it: a number, one number an element, or a function of the
#: coordinates (dim, ...).
Given = Annotated[Any, float | Array | Callable[[Array], ArrayLike]]

#: Flow rules with which a strength is reduced, see :meth:`Material.reduced`.
Flow = Literal["given", "associated", "davis_a", "davis_b", "davis_c", "lagged"]
FLOWS: tuple[str, ...] = get_args(Flow)

#: Names of internal variables that results ask for.
PLASTIC_STRAIN = "plastic strain"
EXCESS_PRESSURE = "excess pore pressure"


class Internal(NamedTuple):
    """Internal variable that a material declares.

    Results show the variables ``"plastic strain"`` and ``"excess pore pressure"`` separately.

    Attributes
    ----------
    name, unit : str
        Name, and unit for the reader.
    initial : float
        Value of unstressed ground, see :meth:`Material.initial_internal`.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.Internal("void ratio", initial=0.8)
    Internal(name='void ratio', initial=0.8, unit='')
    """

    name: str
    initial: float = 0.0
    unit: str = ""


class Update(NamedTuple):
    """Response of a material to a strain increment.

    Attributes
    ----------
    stress, internal : ndarray, shapes (ncomp, ...) and (n_internal, ...)
        New stress and new internal variables.
    plastic : ndarray of int, shape (n_plastic,)
        Flat (C-order) indices of the points whose tangent differs from the elasticity.
    tangent : callable
        ``tangent()`` computes d stress / d strain at these points, shape (n_plastic, ncomp, ncomp).
    """

    stress: Array
    internal: Array
    plastic: NDArray[np.intp]
    tangent: Callable[[], Array]


class Material:
    """Constitutive law: pure functions of strain increment and accepted state.

    An instance holds parameters only. A law defines :meth:`elasticity` and :meth:`update`; all
    other members have defaults. Arrays have the components first: stress (ncomp, n_elements, ...),
    tension positive, 4 components (xx, yy, zz, xy) or 6 (xx, yy, zz, xy, yz, zx); strains with
    engineering shear; internal variables (n_internal, n_elements, ...).

    Attributes
    ----------
    internal : tuple of Internal
        Declared internal variables. In a dataclass write it without an annotation, which would make
        a parameter.
    time_dependent : bool
        Whether :meth:`update` takes the time increment ``dt`` as its last argument.
    stress_dependent : bool
        Whether :meth:`elasticity` takes the accepted stress and internal variables.
    hyperelastic : bool
        Whether stress is a function of elastic strain, :meth:`at_strain`. Increments have no error
        then.
    undrained : bool
        Whether the stress contains an excess pore pressure, which :meth:`drained` removes.
    upright : bool
        Whether the last axis is the vertical one: models refuse gravity along others.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> from skfem_contact.materials import Update
    >>> class Soft(sc.Material):
    ...     def elasticity(self, ncomp, stress=None, internal=None):
    ...         return np.diag([2.0] * 3 + [1.0] * (ncomp - 3))
    ...     def update(self, strain_increment, stress, internal):
    ...         new = stress + np.tensordot(self.elasticity(len(stress)), strain_increment, 1)
    ...         tangent = np.zeros((0, len(stress), len(stress)))
    ...         return Update(new, internal, np.zeros(0, int), lambda: tangent)
    >>> sc.testing.check_material(Soft()) < 1e-6
    True
    """

    internal: tuple[Internal, ...] = ()
    time_dependent: bool = False
    stress_dependent: bool = False
    hyperelastic: bool = False
    undrained: bool = False
    upright: bool = False

    def elasticity(
        self,
        ncomp: int,
        stress: Array | None = None,
        internal: Array | None = None,
    ) -> Array:
        """Return the elastic stiffness d stress / d strain, (ncomp, ncomp).

        Parameters that are arrays give (n_elements, ncomp, ncomp). Only a `stress_dependent`
        material gets the accepted state, whose stiffness is (n_elements, ..., ncomp, ncomp);
        without a state it returns a typical stiffness.
        """
        raise NotImplementedError

    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        """Return the response to a strain increment from an accepted state.

        Raise `errors.IncrementTooLarge` where the law has no solution for the increment: a smaller
        one follows.
        """
        raise NotImplementedError

    def elastic_strain(self, stress: Array, internal: Array) -> Array | None:
        """Return elastic strains of an accepted state, (ncomp, n_elements, ...).

        Solids of finite kinematics ask for them. None stands for the strains that the elasticity of
        the state gives; a law that is elastic, but not linear, overrides this method.
        """

    def at_strain(self, strain: Array, internal: Array) -> Update:
        """Return the response to elastic strains of a `hyperelastic` law."""
        raise NotImplementedError

    @property
    def label(self) -> str:
        """Name of the law in messages."""
        return type(self).__name__

    @property
    def n_internal(self) -> int:
        """Number of internal variables."""
        return len(self.internal)

    @property
    def symmetric(self) -> bool:
        """True if the tangent is symmetric."""
        return False

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of the parameters that are functions of the coordinates."""
        return ()

    def at(self, x: Array) -> Material:
        """Return the material with the values of its functions at points.

        The coordinates `x` are (dim, n_elements, n_points).
        """
        return self

    @property
    def reducible(self) -> bool:
        """True if the material has a strength to reduce."""
        return type(self).reduced is not Material.reduced

    @property
    def dilates(self) -> bool:
        """True if the volume grows by plastic flow."""
        return False

    @property
    def dilates_less(self) -> bool:
        """True if the dilation angle is smaller than the friction angle."""
        return False

    @property
    def slips_on_planes(self) -> bool:
        """True if plastic strains lie along planes of given directions alone."""
        return False

    @property
    def axisymmetric(self) -> bool:
        """True if the material is the same all round an axis of symmetry."""
        return True

    @property
    def tensile_strength(self) -> Parameter | None:
        """Largest principal stress that the material admits, None if it is unknown or unlimited."""
        return None

    def initial_internal(self, stress: Array) -> Array:
        """Return internal variables of ground under an initial stress.

        By default they have the declared initial values. A law overrides this method if its memory
        follows from the stress, for instance a preconsolidation pressure.
        """
        values = np.zeros((self.n_internal, *stress.shape[1:]))
        for row, variable in zip(values, self.internal):
            row[...] = variable.initial
        return values

    def variable(self, name: str, internal: Array) -> Array | None:
        """Return the internal variable of a name, or None if the material does not declare it."""
        for variable, values in zip(self.internal, internal):
            if variable.name == name:
                return values
        return None

    def yielding(self, before: Array, after: Array) -> NDArray[np.bool_]:
        """Return a mask of the points that have flowed between two arrays of internal variables.

        By default these are the points whose ``"plastic strain"`` has grown.
        """
        strain = self.variable(PLASTIC_STRAIN, after)
        earlier = self.variable(PLASTIC_STRAIN, before)
        if strain is None or earlier is None:
            return np.zeros(after.shape[1:], bool)
        return strain > earlier

    def mobilised(self, stress: Array, internal: Array) -> tuple[Array, Array] | None:
        """Return a measure of shear and its limit, None if they are unknown.

        Their ratio is the mobilised strength; the limit is infinite without failure.
        """
        return None

    def undrained_strength(self, mean: Array, internal: Array) -> Array | None:
        """Return the undrained shear strength in plane strain, None if it is unknown.

        The argument `mean` is the mean effective stress in the plane, compression positive.
        """
        return None

    def cone(self, flow: Flow = "associated") -> tuple[Parameter, Parameter, Parameter] | None:
        """Return cohesion, tan(phi) and tensile strength in plane strain for limit analysis.

        The flow is associated or one of Davis'. The cohesion of a rigid material is infinite. None
        means that the material has no bounds.
        """
        return None

    def lines(
        self,
        stress: float,
        inner: bool = True,
        flow: Flow = "associated",
    ) -> tuple[Array, Array] | None:
        """Return c and tan(phi) of lines inside or outside of a curved strength, None if straight.

        The lines, (n_lines, 2, n), resolve stresses up to about a given one, and are inside up to
        the returned compression, (n,).
        """

    def cohesion_at(self, x: Array) -> Array | None:
        """Return the cohesion of the associated cone at points, None if it is no function."""

    def reduced(self, factor: float, flow: Flow = "given") -> Material:
        """Return the material with its strength divided by a positive factor.

        A flow that the law does not have is refused.

        Parameters
        ----------
        factor : float
            Strength reduction factor.
        flow : str
            ``"given"``: the strength is divided, the dilatancy stays unless it exceeds the new
            friction; ``"associated"``: psi = phi; ``"davis_a"``: Davis' beta of the unreduced soil;
            ``"davis_b"``: beta of the reduced soil with its psi; ``"davis_c"``: the same with
            tan(psi) divided as well; ``"lagged"``: as given, with the friction of the pressure at
            the start of each step. A material of one flow ignores it.
        """
        raise ValueError(
            f"{self.label} has no strength to reduce: it has no method reduced(factor, flow)"
        )

    def associated_bound(self, factor: float) -> float:
        """Return the factor at which the associated material is no stronger than Davis' (B) here.

        Where the soils of Davis collapse at `factor`, associated soils are unstable at the largest
        bound of all materials, and so are soils of less dilatancy (Radenkovic's theorem).
        """
        return factor

    def drained(self, stress: Array, internal: Array) -> tuple[Array, Array]:
        """Return accepted stress and internal variables without their excess pore pressure."""
        return stress, internal

    def _positive(self, *names: str) -> None:
        """Refuse values of some parameters that are not positive."""
        for name in names:
            value = getattr(self, name)
            require(name, value, np.greater(value, 0), "be positive")

    def _not_negative(self, *names: str) -> None:
        """Refuse negative values of some parameters."""
        for name in names:
            value = getattr(self, name)
            if value is not None:
                require(name, value, np.greater_equal(value, 0), "not be negative")


#: Members that a law may bring without deriving from :class:`Material`.
_MEMBERS = frozenset(name for name in dir(Material) if not name.startswith("_"))


class _Completed(Material):
    """Law that does not derive from :class:`Material`, with the defaults of the contract."""

    def __init__(self, law: Any) -> None:
        self._law = law
        self._brought = _MEMBERS.intersection(dir(law))

    def __getattribute__(self, name: str) -> Any:
        own = super().__getattribute__
        brought = own("__dict__").get("_brought", ())
        if name in brought:
            return getattr(own("_law"), name)
        return own(name)

    def __repr__(self) -> str:
        return repr(self._law)

    @property
    @override
    def label(self) -> str:
        return type(self._law).__name__

    @property
    @override
    def reducible(self) -> bool:
        return "reduced" in self._brought


def as_material(law: Any) -> Material:
    """Return a law with the defaults of the contract; refuse laws without elasticity or update."""
    if isinstance(law, type):
        raise ValueError(
            f"{law.__name__} is no material, but a class: give an object, {law.__name__}(...)"
        )
    missing = []
    for name in ("elasticity", "update"):
        method = getattr(law, name, None)
        inherited = getattr(method, "__func__", None) is getattr(Material, name)
        if inherited or not callable(method):
            missing.append(name)
    if missing:
        raise ValueError(f"{law!r} is no material: {' and '.join(missing)} missing")
    if isinstance(law, Material):
        return law
    return _Completed(law)


def as_given(law: Any) -> Any:
    """Return a law as its user gave it."""
    return getattr(law, "_law", law)


def parameters_of(law: Any) -> dict[str, Any]:
    """Return the parameters of a law by their names, none where it is no dataclass."""
    own = as_given(law)
    parts = getattr(type(own), "__dataclass_fields__", {})
    return {name: getattr(own, name) for name, part in parts.items() if part.init}


def bulk_modulus_of(D: Array) -> Array:
    """Return bulk moduli, (...), of elastic stiffnesses, (..., ncomp, ncomp).

    They give the mean stress of the same strain along all three axes.
    """
    return np.asarray(D[..., :3, :3].mean(axis=(-1, -2)))


def updated(
    material: Material,
    strain_increment: Array,
    stress: Array,
    internal: Array,
    dt: float,
) -> Update:
    """Call the update of a material, with the time increment if it asks for it."""
    time = (dt,) if material.time_dependent else ()
    return material.update(strain_increment, stress, internal, *time)


def check_reduction(factor: float, flow: str, material: Material | None = None) -> None:
    """Check a reduction factor, a flow rule, and that the strength of a material has values."""
    require("factor", factor, np.isfinite(factor) and factor > 0, "be positive")
    if flow not in FLOWS:
        raise ValueError(f"flow must be one of {', '.join(FLOWS)}, not {flow!r}")
    if material is None:
        return
    names = sorted(set(material.functions) - {"E", "nu"})
    if names:
        raise ValueError(
            f"{material.label} varies with the coordinates in {', '.join(names)}: "
            "reduce material.at(x)"
        )


def as_parameter(name: str, value: ArrayLike, ndim: int = 1) -> Parameter:
    """Return a finite float, or a read-only array by element, or by point with `ndim` 2."""
    array = finite(value, name)
    if array.ndim > ndim or array.size == 0:
        raise ValueError(
            f"{name} must be a number or one number an element, got shape {array.shape}"
        )
    if array.ndim == 0:
        return float(array)
    array.flags.writeable = False
    return array


def as_parameters(material: Any) -> None:
    """Check the fields of a frozen dataclass that are numbers; arrays must agree in length."""
    lengths = {}
    for field in fields(material):
        value = getattr(material, field.name)
        omitted = value is None and field.default is None
        choice = isinstance(field.default, bool)
        if omitted or choice or callable(value):
            continue
        parameter = as_parameter(field.name, value)
        object.__setattr__(material, field.name, parameter)
        if isinstance(parameter, np.ndarray):
            lengths[field.name] = len(parameter)
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        raise ValueError(f"parameter arrays must have one value an element: {listed}")


def require(name: str, value: Parameter, holds: Any, demand: str) -> None:
    """Raise a ValueError that names the first element where a parameter misses a demand."""
    if np.all(holds):
        return
    mask = np.atleast_1d(holds)
    first = np.unravel_index(int(np.argmin(mask)), mask.shape)
    actual = np.broadcast_to(value, mask.shape)[first]
    where = f" in element {first[0]}" if mask.size > 1 else ""
    raise ValueError(f"{name} must {demand}, got {actual}{where}")


def check_shapes(strain_increment: Array, stress: Array) -> None:
    """Refuse strain increments and stresses that are not both (4 or 6, n_elements, ...)."""
    known = stress.ndim >= 2 and stress.shape[0] in (4, 6)
    if not known or strain_increment.shape != stress.shape:
        raise ValueError(
            "strain increment and stress must share a shape (4 or 6, n_elements, ...), "
            f"got {strain_increment.shape} and {stress.shape}"
        )


def along_elements(value: Parameter, shape: tuple[int, ...]) -> Parameter:
    """Return a parameter at the points of a field (ncomp, n_elements, ...); a float stays one."""
    if not isinstance(value, np.ndarray):
        return value
    if len(value) != shape[1]:
        raise ValueError(f"a parameter array has {len(value)} values for {shape[1]} elements")
    if value.ndim == 1:
        n_points = int(np.prod(shape[2:]))
        return np.repeat(value, n_points).reshape(shape[1:])
    if len(shape) == 2:
        return value.mean(axis=1)
    return np.broadcast_to(value, shape[1:])


def warn_of_radians(**angles: Parameter) -> None:
    """Warn about angles that are so small that radians may have been meant."""
    for name, angle in angles.items():
        largest = float(np.max(angle))
        if 0.0 < largest < np.pi / 2:
            warn(f"{name} is {largest:.4g}: angles are given in degrees")
