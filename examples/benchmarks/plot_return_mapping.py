r"""
Speed and accuracy of the return mappings
=========================================

In every iteration each integration point asks its material for the stress, and for the tangent
where it yields. How many points a second, and how exactly? Every law is timed while nothing, a
sixth and everything yields. The stresses are compared with an independent solution that tries all
sets of active planes of the yield surface, the tangents with difference quotients of the stresses.

Run with ``--full`` for a million points, and with ``--peers`` for the return mapping of xslope,
which returns stresses without a tangent and without dilatancy. Its rate is measured in turn with
ours, on the same trial stresses.
"""

import json
import sys
from itertools import combinations, permutations
from statistics import median
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from one_program import version_of

import skfem_contact as sc

FULL = "--full" in sys.argv
N = 1_000_000 if FULL else 20_000
PEERS = "--peers" in sys.argv
REPEATS, SAMPLE = 7 if FULL else 3, 400
E, NU, C, PHI = 1e4, 0.3, 10.0, 30.0
LAME, SHEAR = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))

laws = {
    "Mohr-Coulomb": sc.MohrCoulomb(E, NU, C, PHI),
    "Mohr-Coulomb, psi = 10": sc.MohrCoulomb(E, NU, C, PHI, psi=10.0),
    "Mohr-Coulomb, cut-off": sc.MohrCoulomb(E, NU, C, PHI, tension=5.0),
    "Mohr-Coulomb, softening": sc.HardeningMohrCoulomb(
        E, NU, c=C, c_end=4.0, phi=PHI, phi_end=20.0, strain_end=0.2
    ),
    "Tresca": sc.Tresca(E, NU, c=40.0),
    "von Mises": sc.VonMises(E, NU, strength=70.0),
    "Drucker-Prager": sc.DruckerPrager.plane_strain(E, NU, C, PHI, psi=10.0),
}

# %%
# Points
# ------
# Each point is under an isotropic pressure between 50 and 150. Those that yield get a deviator of
# two to four times that, in any direction of the stress space, and a mean stress from compression
# to tension: they return to faces, edges and the apex.


def points(n: int, share: float, ncomp: int) -> tuple[np.ndarray, np.ndarray]:
    """Accepted stresses and trial stresses, (ncomp, n), of which a share lies outside of the yield
    surfaces.
    """
    rng = np.random.default_rng(0)
    pressure, isotropic = rng.uniform(50, 150, n), np.r_[np.ones(3), np.zeros(ncomp - 3)][:, None]
    outside = rng.random(n) < share
    direction = rng.normal(size=(ncomp, n))
    direction -= isotropic * direction[:3].mean(axis=0)
    direction /= np.sqrt((direction[:3] ** 2).sum(axis=0) + 2 * (direction[3:] ** 2).sum(axis=0))
    deviator = pressure * np.where(outside, rng.uniform(2, 4, n), 0.05) * direction
    stress = -pressure * isotropic
    return stress, stress + deviator + np.where(
        outside, rng.uniform(-0.5, 1.3, n), 0.0
    ) * pressure * isotropic


# %%
# The independent solution
# ------------------------
# Koiter's rule in principal stresses: of all sets of up to three active planes that one holds whose
# multipliers and yield functions have the right signs. Where :math:`\psi < \varphi` no set may
# hold: these stresses belong to the apex.

TENSOR = {
    4: np.array([[0, 3, -1], [3, 1, -1], [-1, -1, 2]]),
    6: np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]]),
}


def principal(stress: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Principal stresses (n, 3) and directions (n, 3, 3)."""
    padded = np.vstack((stress, np.zeros((1, stress.shape[1]))))
    return np.linalg.eigh(padded[TENSOR[len(stress)]].transpose(2, 0, 1))


def active_set(trial, normals, flows, limits):
    """Principal stresses (n, 3) after the return to planes (n, m, 3), and where a set of planes was
    found.
    """
    elastic = LAME + 2 * SHEAR * np.eye(3)
    scale = 1e-11 * np.abs(trial).max(axis=1)
    stress, found = trial.copy(), ((normals @ trial[:, :, None])[..., 0] <= limits).all(axis=1)
    for planes in (
        list(p) for count in (1, 2, 3) for p in combinations(range(normals.shape[1]), count)
    ):
        todo = np.flatnonzero(~found)
        drops, face = flows[todo][:, planes] @ elastic, normals[todo][:, planes]
        matrix = face @ drops.transpose(0, 2, 1) / E
        regular = np.abs(np.linalg.det(matrix)) > 1e-6
        todo, drops, face, matrix = todo[regular], drops[regular], face[regular], matrix[regular]
        excess = (face @ trial[todo, :, None])[..., 0] - limits[todo][:, planes]
        factors = np.linalg.solve(matrix, excess[..., None])[..., 0] / E
        candidate = trial[todo] - np.einsum("ni,nij->nj", factors, drops)
        inside = (normals[todo] @ candidate[:, :, None])[..., 0] <= limits[todo] + scale[todo, None]
        holds = inside.all(axis=1) & (factors * E >= -scale[todo, None]).all(axis=1)
        stress[todo[holds]] = candidate[holds]
        found[todo[holds]] = True
    return stress, found


def planes_solution(trial, c, phi, psi=0.0, tension=None):
    """Mohr-Coulomb and Tresca with the strength of each point, (n,) or a number."""
    values, directions = principal(trial)
    n, unit = len(values), np.eye(3)
    pairs = np.array(list(permutations(range(3), 2)))
    sines = [np.broadcast_to(np.sin(np.deg2rad(angle)), n)[:, None, None] for angle in (phi, psi)]
    normals, flows = ((1 + s) * unit[pairs[:, 0]] - (1 - s) * unit[pairs[:, 1]] for s in sines)
    limits = np.broadcast_to(2 * c * np.cos(np.deg2rad(phi)), n)[:, None] * np.ones(6)
    if tension is not None:
        cut = np.broadcast_to(unit, (n, 3, 3))
        normals, flows = (
            np.concatenate((normals, cut), axis=1),
            np.concatenate((flows, cut), axis=1),
        )
        limits = np.concatenate((limits, np.full((n, 3), tension)), axis=1)
    stress, found = active_set(values, normals, flows, limits)
    if not found.all():
        stress[~found] = np.broadcast_to(c / np.tan(np.deg2rad(phi)), n)[~found, None]
    tensor = np.einsum("nik,nk,njk->ijn", directions, stress, directions)
    index = np.array([[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]])[: len(trial)]
    return tensor[index[:, 0], index[:, 1]]


def cone_solution(trial, k, alpha=0.0, beta=0.0):
    """Drucker-Prager and von Mises: one equation for the multiplier, or the apex."""
    isotropic = np.r_[np.ones(3), np.zeros(len(trial) - 3)][:, None]
    first = trial[:3].sum(axis=0)
    deviator = trial - isotropic * first / 3
    root = np.sqrt((deviator[:3] ** 2).sum(axis=0) / 2 + (deviator[3:] ** 2).sum(axis=0))
    bulk = LAME + 2 * SHEAR / 3
    factor = np.maximum(root + alpha * first - k, 0) / (SHEAR + 9 * bulk * alpha * beta)
    on_cone = (
        deviator * (1 - SHEAR * factor / root) + isotropic * (first - 9 * bulk * beta * factor) / 3
    )
    return np.where(
        root > SHEAR * factor, on_cone, isotropic * k / (3 * alpha) if alpha else np.nan
    )


def solution(law, trial, internal):
    """The independent stresses; a strength that changes is taken at the end of the increment."""
    if isinstance(law, sc.HardeningMohrCoulomb):
        part = np.minimum(internal[0] / law.strain_end, 1)
        return planes_solution(
            trial, law.c + part * (law.c_end - law.c), law.phi + part * (law.phi_end - law.phi)
        )
    if isinstance(law, sc.MohrCoulomb):
        return planes_solution(trial, law.c, law.phi, law.psi, law.tension)
    if isinstance(law, sc.Tresca):
        return planes_solution(trial, law.c, 0.0)
    if isinstance(law, sc.VonMises):
        return cone_solution(trial, law.strength / np.sqrt(3))
    return cone_solution(trial, law.k, law.alpha, law.beta)


# %%
# Errors
# ------
# A stress error is relative to the largest component of the trial stress. The internal variable, on
# which the strength of the softening law depends, must be the equivalent plastic shear strain of
# the return. A tangent error is relative to E; points where the quotients to both sides differ lie
# on a kink or have nearly equal principal stresses, and are left out.


def stress_error(stress: np.ndarray, law, trial: np.ndarray, internal: np.ndarray) -> float:
    """Largest relative error of a stress."""
    difference = np.abs(stress - solution(law, trial, internal)).max(axis=0)
    return float((difference / np.abs(trial).max(axis=0)).max())


def plastic_strain_error(stress: np.ndarray, trial: np.ndarray, internal: np.ndarray) -> float:
    """Largest error of the internal variable against the strain that relaxes the trial stress."""
    relaxed = (trial - stress) / (2 * SHEAR)
    relaxed[:3] -= relaxed[:3].mean(axis=0)
    strain = np.sqrt(2 / 3 * ((relaxed[:3] ** 2).sum(axis=0) + 2 * (relaxed[3:] ** 2).sum(axis=0)))
    return float(np.abs(strain - internal[0]).max())


def tangent_error(law, strain: np.ndarray, stress: np.ndarray) -> float:
    """Largest relative error of a component of the tangent."""
    ncomp, n = strain.shape
    internal, h = np.zeros((law.n_internal, n)), 1e-6
    update = law.update(strain, stress, internal)
    tangent = np.broadcast_to(law.elasticity(ncomp), (n, ncomp, ncomp)).copy()
    tangent[update.plastic] = update.tangent()
    forward, backward = (
        np.stack(
            [
                sign
                * (
                    law.update(strain + sign * h * e[:, None], stress, internal).stress
                    - update.stress
                )
                / h
                for e in np.eye(ncomp)
            ],
            axis=2,
        ).transpose(1, 0, 2)
        for sign in (1, -1)
    )
    smooth = np.abs(forward - backward).max(axis=(1, 2)) < 1e-3 * E
    assert smooth.mean() > 0.9
    return float(np.abs(tangent - (forward + backward) / 2)[smooth].max() / E)


# %%
# Measurement
# -----------
# The time of a law is that of its stresses, internal variables and tangents, from the strain
# increments.


def law_once(
    law, strain: np.ndarray, stress: np.ndarray, internal: np.ndarray
) -> sc.materials.Update:
    """Everything an iteration asks of a material."""
    update = law.update(strain, stress, internal)
    update.tangent()
    return update


def timed(calls: list) -> list[float]:
    """Median process times of some calls, measured in turn."""
    times = [[] for _ in calls]
    for _ in range(REPEATS):
        for call, own in zip(calls, times, strict=True):
            begin = process_time()
            call()
            own.append(process_time() - begin)
    return [median(own) for own in times]


def peer_call(trial: np.ndarray):
    """Stresses of xslope for Mohr-Coulomb, as a function to call; its order of components is xx,
    yy, xy, zz.
    """
    from xslope.fem import mc_return_map

    ordered = np.ascontiguousarray(trial[[0, 1, 3, 2]].T)
    c, sine, cosine, mu = (
        np.full(len(ordered), value)
        for value in (C, np.sin(np.deg2rad(PHI)), np.cos(np.deg2rad(PHI)), SHEAR)
    )
    return lambda: mc_return_map(ordered, c, sine, cosine, mu)[0][:, [0, 1, 3, 2]].T


def row(method: str, cpu: float, error: float, share: float) -> dict:
    """A line of the result."""
    print(
        f"{method:31} {share:6.1%} yield  {N / cpu / 1e6:7.2f} million points/s   error {error:.1e}"
    )
    return {
        "method": method,
        "n": N,
        "error": error,
        "cpu_s": round(cpu, 4),
        "points_per_s": round(N / cpu),
        "plastic": round(share, 3),
    }


def measure(name: str, law, share: float, ncomp: int, with_peer: bool) -> list[dict]:
    """Rows of a law, and of the peer on the same points."""
    stress, trial = points(N, share, ncomp)
    strain, internal = (
        np.linalg.solve(law.elasticity(ncomp), trial - stress),
        np.zeros((law.n_internal, N)),
    )
    peer = peer_call(trial) if with_peer else None
    calls = [lambda: law_once(law, strain, stress, internal)] + ([peer] if peer else [])
    for call in calls:
        call()
    times, update = timed(calls), law.update(strain, stress, internal)
    some = np.linspace(0, N - 1, SAMPLE).astype(int)
    error = stress_error(update.stress[:, some], law, trial[:, some], update.internal[:, some])
    error_of_tangent = tangent_error(law, strain[:, some], stress[:, some])
    yielding = update.plastic.size / N
    rows = [{**row(name, times[0], error, yielding), "tangent_error": error_of_tangent}]
    assert error < 1e-12
    assert (
        plastic_strain_error(update.stress[:, some], trial[:, some], update.internal[:, some])
        < 1e-12
    )
    assert error_of_tangent < 1e-5  # of the difference quotient
    if peer:
        rows.append(
            {
                **row(
                    "xslope, stress only",
                    times[1],
                    stress_error(peer()[:, some], law, trial[:, some], update.internal[:, some]),
                    yielding,
                ),
                "peer": version_of("xslope"),
            }
        )
        allowed = 1 if yielding <= 0.2 else 3
        print(
            f"    stress and tangent take {times[0] / times[1]:.2f} times as long as the peer's "
            f"stress"
        )
        assert times[0] <= allowed * times[1]
    return rows


rows = []
for share in (0.0, 1 / 6, 1.0):
    for name, law in laws.items():
        rows += measure(name, law, share, 4, with_peer=PEERS and name == "Mohr-Coulomb")
    rows += measure(
        "Mohr-Coulomb, three dimensions", laws["Mohr-Coulomb"], share, 6, with_peer=False
    )

# %%
# Curved surfaces
# ---------------
# Modified Cam Clay and Hoek-Brown solve one scalar equation a point. They are timed in turn with
# Mohr-Coulomb, and all points yield. The error is what a zero increment changes afterwards, as a
# share of the mean stress: an inadmissible stress would return a second time.

curved = {
    "Modified Cam Clay": sc.CamClay(kappa=0.02, lambda_=0.1, M=1.2, nu=0.25, p_ref=100.0),
    "Modified Cam Clay, Lode": sc.CamClay(
        kappa=0.02, lambda_=0.1, M=1.2, nu=0.25, p_ref=100.0, extension=0.75
    ),
    "Hoek-Brown": sc.HoekBrown(E, NU, sigma_ci=100.0, m_b=2.0, s=0.1, a=0.51),
    "Hoek-Brown, psi = 10": sc.HoekBrown(E, NU, sigma_ci=100.0, m_b=2.0, s=0.1, a=0.51, psi=10.0),
}
stress, trial = points(N, 1.0, 4)
strain = np.linalg.solve(laws["Mohr-Coulomb"].elasticity(4), trial - stress)
memory = [
    law.initial_internal(stress[:, :, None])[:, :, 0]
    for law in (laws["Mohr-Coulomb"], *curved.values())
]
calls = [
    lambda law=law, internal=internal: law_once(law, strain, stress, internal)
    for law, internal in zip((laws["Mohr-Coulomb"], *curved.values()), memory, strict=True)
]
for call in calls:
    call()
reference, *times = timed(calls)
for (name, law), internal, cpu in zip(curved.items(), memory[1:], times, strict=True):
    update = law.update(strain, stress, internal)
    again = law.update(np.zeros_like(strain), update.stress, update.internal)
    error = float(
        (
            np.abs(again.stress - update.stress).max(axis=0)
            / np.abs(update.stress[:3].mean(axis=0))
        ).max()
    )
    share = float(law.yielding(internal, update.internal).mean())
    rows.append(
        {**row(name, cpu, error, share), "time_over_mohr_coulomb": round(cpu / reference, 2)}
    )
    print(
        f"    {1e6 * cpu / N:.2f} us a point, {cpu / reference:.2f} times as long as Mohr-Coulomb"
    )
    assert error < 1e-8

# %%
# Hardening Soil
# --------------
# Its points start from the stresses of normally consolidated ground. Strains of 1e-5 to 1e-4 are
# those of an increment of construction. The ratio is to Mohr-Coulomb of the same run where every
# point yields. The error is what a strain increment of zero changes, relative to the mean stress.


def hardening_row(n: int = 50_000 if FULL else 5_000) -> dict:
    """Time of Hardening Soil on random increments, and its ratio to that of Mohr-Coulomb."""
    rng = np.random.default_rng(0)
    sand = sc.HardeningSoil(37e3, 29.6e3, 90e3, m=0.5, c=1.0, phi=41.0, psi=14.0, K0nc=0.34)
    stress = -rng.uniform(20, 400, n) * np.array([0.34, 1.0, 0.34, 0.0])[:, None]
    strain = 10 ** rng.uniform(-5, -4, n) * rng.choice([-1.0, 1.0], (4, n))
    internal = sand.initial_internal(stress)
    (own,) = timed([lambda: law_once(sand, strain, stress, internal)])
    ratio = own / n * N / [r for r in rows if r["method"] == "Mohr-Coulomb"][-1]["cpu_s"]
    update = sand.update(strain, stress, internal)
    again = sand.update(np.zeros_like(strain), update.stress, update.internal)
    error = float(
        (np.abs(again.stress - update.stress) / np.abs(update.stress[:3].mean(axis=0))).max()
    )
    print(f"Hardening Soil {1e6 * own / n:.2f} us a point, {ratio:.1f} times Mohr-Coulomb")
    assert error < 1e-8
    yielding = float((update.internal[0] > internal[0]).mean())
    return {
        **row("Hardening Soil", own * N / n, error, yielding),
        "n": n,
        "cpu_s": round(own, 4),
        "time_over_mohr_coulomb": round(ratio, 2),
    }


rows.append(hardening_row())

# %%
# Picture
# -------
names = list(dict.fromkeys(r["method"] for r in rows))
fig, ax = plt.subplots(figsize=(8, 4.2), layout="constrained")
for i, (share, color) in enumerate(
    zip(("nothing", "a sixth", "everything"), ("C2", "C0", "C3"), strict=True)
):
    rates = [
        ([r["points_per_s"] for r in rows if r["method"] == name] * 3)[i] / 1e6 for name in names
    ]
    bars = ax.barh(
        np.arange(len(names)) + 0.27 * (i - 1), rates, 0.25, color=color, label=f"{share} yields"
    )
    ax.bar_label(
        bars, fmt=lambda rate: f"{rate:.0f}" if rate >= 10 else f"{rate:.2g}", fontsize=7, padding=2
    )
ax.set(
    xscale="log",
    xticks=[1, 10, 100],
    xticklabels=["1", "10", "100"],
    xlim=(0.1, 300),
    yticks=np.arange(len(names)),
    yticklabels=names,
    xlabel="million points a second, stress and tangent",
)
ax.invert_yaxis()
ax.legend(frameon=False, loc="upper center", bbox_to_anchor=(0.4, 1.12), ncols=3)
plt.show()

# %%
# Headline numbers
# ----------------
print(json.dumps({"case": "return mapping", "rows": rows}))
