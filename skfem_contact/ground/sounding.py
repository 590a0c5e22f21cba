"""Cone penetration tests: readings, soil behaviour, and layers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy import ndarray

from ..checks import positive
from .columns import Column
from .correlations import CORRELATIONS, Profile

#: Atmospheric pressure and unit weight of water, kPa and kN/m³.
ATMOSPHERE = 100.0
WATER = 9.81
#: Names of soils by their zones of soil behaviour, 2 to 7 (Robertson 2009, Table 1).
SOILS = {
    2: "organic soil",
    3: "clay",
    4: "silt mixture",
    5: "sand mixture",
    6: "sand",
    7: "gravelly sand",
}
#: Upper limits of the index of soil behaviour of zones 7 to 3.
_LIMITS = (1.31, 2.05, 2.60, 2.95, 3.60)
#: Change of the exponent of stresses at which its iteration ends, and most iterations.
_CLOSE = 1e-3
_ITERATIONS = 50


@dataclass(frozen=True)
class Sounding:
    """Readings of a cone penetration test, in kPa and m.

    Attributes
    ----------
    name
        Name of the test.
    position
        Easting and northing in m.
    level
        Height of the surface in m.
    depth
        Depths of the readings below the surface, (n,).
    cone
        Cone resistance q_c, (n,), NaN where the file has no reading.
    sleeve
        Sleeve friction f_s, (n,), NaN likewise.
    pore
        Pore pressure u_2, (n,), NaN likewise or where it was not measured.
    area_ratio
        Area ratio of the cone, by which q_t = q_c + (1 - a) u_2; None if it is not in the file.
    water
        Depth of the water table in m, None if it is not in the file.
    remarks
        Readings that were left out or corrected, in words.
    """

    name: str
    position: tuple[float, ...]
    level: float
    depth: ndarray
    cone: ndarray
    sleeve: ndarray
    pore: ndarray
    area_ratio: float | None = None
    water: float | None = None
    remarks: tuple[str, ...] = field(default=())

    @property
    def measured(self) -> ndarray:
        """True where cone resistance and sleeve friction were measured, (n,)."""
        return np.isfinite(self.cone) & np.isfinite(self.sleeve)

    @property
    def resistance(self) -> ndarray:
        """Cone resistance q_t with the pore pressure behind the tip, (n,), else q_c."""
        ratio = 1.0 if self.area_ratio is None else self.area_ratio
        correction = (1.0 - ratio) * self.pore
        return self.cone + np.where(np.isfinite(correction), correction, 0.0)

    def behaviour(
        self, unit_weight: float | None = None, water: float | None = None
    ) -> dict[str, ndarray]:
        r"""Return normalised resistances and the index of soil behaviour at the readings.

        Parameters
        ----------
        unit_weight
            Unit weight of the ground in kN/m³; by default from the readings (Robertson & Cabal
            2010), as ``CORRELATIONS["unit_weight"]`` says.
        water
            Depth of the water table in m, below which the ground is saturated; by default that of
            the file.

        Returns
        -------
        dict
            ``Q_tn``, ``F_r`` in %, ``I_c``, ``zone`` (0 where nothing was measured), and the
            stresses ``total`` and ``effective`` in kPa, each (n,).

        Notes
        -----
        Robertson (2009), Canadian Geotechnical Journal 46, 1337-1355:

        .. math:: Q_{tn} = \frac{q_t - \sigma_{v0}}{p_a}
            \left(\frac{p_a}{\sigma'_{v0}}\right)^n, \quad
            F_r = \frac{f_s}{q_t - \sigma_{v0}}, \quad
            I_c = \sqrt{(3.47 - \lg Q_{tn})^2 + (\lg F_r + 1.22)^2}, \quad
            n = 0.381 I_c + 0.05 \frac{\sigma'_{v0}}{p_a} - 0.15 \le 1
        """
        # Only positive resistances have an index.
        total, effective = self._stresses(unit_weight, water)
        net = self.resistance - total
        with np.errstate(divide="ignore", invalid="ignore"):
            usable = self.measured & (net > 0.0) & (self.sleeve > 0.0) & (effective > 0.0)
            ratio = np.where(usable, 100.0 * self.sleeve / net, np.nan)
            # Iterate the exponent n = 0.381 I_c + 0.05 σ'/p_a - 0.15 <= 1 (Robertson 2009).
            exponent = np.ones(len(net))
            for _ in range(_ITERATIONS):
                scale = (ATMOSPHERE / effective) ** exponent
                normalised = np.where(usable, net / ATMOSPHERE * scale, np.nan)
                index = np.hypot(3.47 - np.log10(normalised), np.log10(ratio) + 1.22)
                new = np.minimum(0.381 * index + 0.05 * effective / ATMOSPHERE - 0.15, 1.0)
                change = np.nanmax(np.abs(new - exponent), initial=0.0)
                exponent = new
                if change < _CLOSE:
                    break
        # Zones follow from the limits of the index.
        zone = np.where(np.isfinite(index), 7 - np.searchsorted(_LIMITS, index, side="right"), 0)
        return {
            "Q_tn": normalised,
            "F_r": ratio,
            "I_c": index,
            "zone": zone,
            "total": total,
            "effective": effective,
        }

    def profile(
        self,
        parameter: str,
        unit_weight: float | None = None,
        water: float | None = None,
        **constants: float,
    ) -> Profile:
        """Return a parameter by depth from a correlation, which the profile names.

        Parameters
        ----------
        parameter
            A key of :data:`CORRELATIONS`: ``"phi"``, ``"su"``, ``"E"``, ``"unit_weight"``.
        unit_weight, water
            As in :meth:`behaviour`.
        constants
            Constants of the correlation, such as ``N_kt=14.0`` of ``"su"``.
        """
        if parameter not in CORRELATIONS:
            raise ValueError(
                f"there is no correlation for '{parameter}'; known are {', '.join(CORRELATIONS)}"
            )
        return CORRELATIONS[parameter].applied(self, self.behaviour(unit_weight, water), constants)

    def column(
        self,
        soils: Mapping[int, str] = SOILS,
        unit_weight: float | None = None,
        water: float | None = None,
        thinnest: float = 0.5,
    ) -> Column:
        """Return layers of one soil behaviour.

        Layers thinner than the thinnest are joined to the neighbour with the nearer mean index.
        Depths without readings belong to the layer above, and the remarks report them.

        Parameters
        ----------
        soils
            Names of soils by zone, 2 to 7. Zones of one name are one soil.
        unit_weight, water
            As in :meth:`behaviour`.
        thinnest
            Smallest thickness of a layer in m.
        """
        missing = [zone for zone in SOILS if zone not in soils]
        if missing:
            raise ValueError(f"soils has no name for zone {missing[0]}; zones are 2 to 7")
        found = self.behaviour(unit_weight, water)
        known = found["zone"] > 0
        if not known.any():
            raise ValueError(f"'{self.name}' has no readings of cone and sleeve")
        depth = self.depth[known]
        names = [soils[zone] for zone in found["zone"][known].tolist()]
        layers = _joined(depth, names, found["I_c"][known], positive(thinnest, "thinnest"))
        pairs = tuple((name, self.level - lower) for name, lower in layers)
        return Column(self.name, self.position, self.level, pairs, self.remarks)

    def _stresses(self, unit_weight: float | None, water: float | None) -> tuple[ndarray, ndarray]:
        """Return total and effective vertical stresses, with water at rest below its table."""
        # Choose the water table.
        table = self.water if water is None else water
        if table is None:
            raise ValueError(
                f"'{self.name}' has no water table: give its depth as water=, or a large one"
            )
        # Choose unit weights, by correlation where none is given.
        if unit_weight is None:
            weights = CORRELATIONS["unit_weight"].values(self, {}, {})
            known = np.isfinite(weights)
            if not known.any():
                raise ValueError(f"'{self.name}' has no readings of cone and sleeve")
            weights = np.interp(self.depth, self.depth[known], weights[known])
        else:
            weights = np.full(len(self.depth), positive(unit_weight, "unit_weight"))
        # Add up: σ = ∫ γ dz, u = γ_w (z - z_w).
        total = np.cumsum(weights * np.diff(self.depth, prepend=0.0))
        return total, total - WATER * np.maximum(self.depth - table, 0.0)


def _joined(
    depth: ndarray,
    names: list[str],
    index: ndarray,
    thinnest: float,
) -> list[tuple[str, float]]:
    """Return soils and lower ends of layers, the thinnest of which are joined to neighbours."""
    # Bounds lie between readings of different soils
    changes = [k for k in range(1, len(names)) if names[k] != names[k - 1]]
    between = [0.5 * (depth[k - 1] + depth[k]) for k in changes]
    starts = [0, *changes]
    ends = [*changes, len(names)]
    bounds = [0.0, *between, depth[-1]]
    layers = []
    for k, (start, end) in enumerate(zip(starts, ends)):
        mean = float(index[start:end].mean())
        layers.append([names[start], bounds[k], bounds[k + 1], mean])

    # Join the thinnest layer to the neighbour with the nearer index until all are thick enough
    while len(layers) > 1:
        thickness = [lower - upper for _, upper, lower, _ in layers]
        thin = int(np.argmin(thickness))
        if thickness[thin] >= thinnest:
            break
        near = [k for k in (thin - 1, thin + 1) if 0 <= k < len(layers)]
        best = min(near, key=lambda k: abs(layers[k][3] - layers[thin][3]))
        layers[best][1] = min(layers[best][1], layers[thin][1])
        layers[best][2] = max(layers[best][2], layers[thin][2])
        del layers[thin]
        layers = _merged(layers)
    return [(layer[0], float(layer[2])) for layer in layers]


def _merged(layers: list[list]) -> list[list]:
    """Return layers, of which neighbours of one soil are one, with its mean index."""
    merged: list[list] = []
    for layer in layers:
        if merged and merged[-1][0] == layer[0]:
            last = merged[-1]
            first = last[2] - last[1]
            second = layer[2] - layer[1]
            last[3] = (first * last[3] + second * layer[3]) / (first + second)
            last[2] = layer[2]
        else:
            merged.append(layer)
    return merged
