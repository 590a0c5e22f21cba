"""What undrained ground shows: its excess pore pressure, and the strength that it has in the short term."""
from __future__ import annotations

from typing import Any

import numpy as np
from numpy import ndarray

from ..materials import Undrained
from ..solid import SolidForm, SolidState


def pore_pressure(form: SolidForm, state: SolidState) -> ndarray:
    """Excess pore pressure in the regions of :class:`Undrained` soil, zero in others.

    It adds to the pressure of :func:`water_load`, which is part of the load.

    Parameters
    ----------
    form
        A solid.
    state
        Its state.

    Returns
    -------
    ndarray
        Positive in compression, (n_elements, n_points) in the order of ``form.basis``.

    Examples
    --------
    A quick load is carried by the water alone:

    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> clay = sc.Undrained(sc.MohrCoulomb(E=1e4, nu=.3, c=5., phi=25., psi=0.), Kw=1e8)
    >>> forms = {"clay": sc.SolidForm(basis, clay)}
    >>> fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    >>> load = basis.zeros()
    >>> load[basis.get_dofs("top").all("u^2")] = -50.
    >>> loaded = sc.run(forms, [sc.Stage("load", load)], fixed, progress=False)["load"]
    >>> sc.pore_pressure(forms["clay"], loaded.states["clay"]).round(1).tolist()
    [[100.0, 100.0, 100.0, 100.0]]
    """
    pressure = np.zeros(form.weight.shape)
    for region in form.regions:
        if isinstance(region.material, Undrained) and len(state.internal) >= region.material.n_internal:
            pressure[region.elements] = state.internal[region.material.n_internal - 1, region.elements]
    return pressure


def soil_of(material: Any) -> Any:
    """The law in effective stresses of a material: that of the soil where the ground is :class:`Undrained`."""
    return material.soil if isinstance(material, Undrained) else material


def undrained_strength(form: SolidForm, state: SolidState) -> dict[str, ndarray]:
    r"""Undrained shear strength in plane strain that follows from the stresses in the ground.

    Without drainage and dilation the mean effective stress in the plane, :math:`s' = -(\sigma_1' + \sigma_3') / 2`,
    stays as it is if the soil is elastic and isotropic before it yields. So the strength is that of the stresses now,

    .. math:: s_u = c \cos\varphi + s' \sin\varphi .

    Parameters
    ----------
    form
        A plane solid.
    state
        Its state; stresses are effective where :func:`water_load` acts.

    Returns
    -------
    dict
        By region with `c` and `phi`: one value for each of its elements, the mean of its points and at least zero,
        (n_elements,), to be the `c` of :class:`Tresca` in that region.

    Raises
    ------
    ValueError
        A solid in space, or no region with `c` and `phi`.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> form = sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=.3, c=0., phi=30.))
    >>> state = form.initial_state()
    >>> state.stress[:3] = -100.
    >>> sc.undrained_strength(form, state)["all"].round(6)
    array([50.])
    """
    if len(state.stress) != 4:
        raise ValueError("the undrained strength is that of plane strain; this solid is in space")
    mean = -0.5 * (state.stress[0] + state.stress[1]) + pore_pressure(form, state)
    mean = (mean * form.weight).sum(axis=1) / form.weight.sum(axis=1)
    strength = {}
    for region in form.regions:
        soil = soil_of(region.material)
        if hasattr(soil, "c") and hasattr(soil, "phi"):
            phi = np.radians(soil.phi)
            strength[region.name] = np.maximum(soil.c * np.cos(phi) + mean[region.elements] * np.sin(phi), 0.0)
    if not strength:
        raise ValueError(f"no region has c and phi; the regions are {list(form.materials)}")
    return strength
