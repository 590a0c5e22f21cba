r"""
Kernels and factors against the machine
=======================================

How fast could they be? A kernel can take no less time than its operations need at the rate of large
products of dense matrices, nor less than its data need at the bandwidth of the memory. Both are
measured here, on one thread:

.. math:: t \ge \max\left( \frac{\text{operations}}{\text{rate of dgemm}},
   \frac{\text{bytes}}{\text{bandwidth}}
   \right).

The share of this bound that a kernel reaches tells what other code could gain at most. Bytes are
those that have to be read and written once, by a cache of any size.
"""

# %%
# The machine
# -----------
# The rate of products of dense matrices, and the bandwidth of :math:`a = b + c` with vectors that
# no cache holds.

import json
import sys
from time import perf_counter

import matplotlib.pyplot as plt
import numpy as np
from scipy.sparse.linalg import splu
from skfem import Basis, ElementHex1, ElementTriP2, ElementVector, MeshHex, MeshTri
from threadpoolctl import threadpool_limits

import skfem_contact as sc
from skfem_contact.forms.assembly import Pattern, element_stiffness, force_matrix, strain_operator
from skfem_contact.solvers.superlu import nested_dissection

FULL = "--full" in sys.argv
TIMES = 7 if FULL else 3


def shortest(function):
    """Shortest wall time of some calls, s."""
    times = []
    for _ in range(TIMES):
        begin = perf_counter()
        function()
        times.append(perf_counter() - begin)
    return min(times)


def machine():
    """Operations and bytes a second."""
    n, m = (1500, 10_000_000) if FULL else (800, 4_000_000)
    A, (a, b, c) = np.random.default_rng(0).random((n, n)), np.ones((3, m))
    return 2 * n**3 / shortest(lambda: A @ A), 3 * a.nbytes / shortest(lambda: np.add(b, c, out=a))


# %%
# Kernels
# -------
# What an iteration does with a body: strains, forces, element matrices, their sum, products with
# the sum, and factors. Operations are additions and multiplications. Those of a factor follow from
# the entries of L and U: with l entries below and u entries right of a pivot they are l + 2 l u.


def by_superlu(K, locations):
    """Operations and bytes of a factor by SuperLU, and its call."""
    order = nested_dissection(K, locations)
    A = K[order][:, order].tocsc()

    def factor():
        return splu(
            A, permc_spec="NATURAL", diag_pivot_thresh=0.01, options={"SymmetricMode": True}
        )

    lu = factor()
    below, right = np.diff(lu.L.indptr) - 1.0, np.bincount(lu.U.indices, minlength=len(order)) - 1.0
    return float((below + 2 * below * right).sum()), 12 * lu.nnz, factor


def by_pardiso(K, locations):
    """Operations and bytes of a factor by PARDISO, from its own report, and its call."""
    from skfem_contact.solvers import pardiso

    pardiso.OPTIONS |= {18: -1, 19: -1}  # report entries and operations
    engine = pardiso.Pardiso()
    engine.factor(K, symmetric=False)
    report = engine._analysis._call._options
    return 1e6 * float(report[18]), 8 * float(report[17]), lambda: engine._analysis.factor(K)


def kernels(dim, n):
    """Names, operations, bytes and calls of the kernels of a body of n elements along its sides."""
    sides = (np.linspace(0.0, 1.0, n + 1),) * dim
    kind, element = (MeshTri, ElementTriP2()) if dim == 2 else (MeshHex, ElementHex1())
    basis = Basis(kind.init_tensor(*sides), ElementVector(element), intorder=2)
    form = sc.SolidForm(basis, sc.LinearElastic(E=2e4, nu=0.3))
    B, weight = strain_operator(form.basis, "full", form.coordinates)
    F, pattern = force_matrix(B, weight, form.basis.element_dofs, basis.N), Pattern.of(form.basis)
    E = form.materials["all"].elasticity(B.shape[2])
    acting = np.flatnonzero(B.any(axis=(0, 1, 3)))  # components of the strain
    B = np.ascontiguousarray(B[:, :, acting])
    n_elements, n_points, r, m = B.shape
    D = E[np.ix_(acting, acting)] * weight[..., None, None]
    u, dofs = (
        np.random.default_rng(0).random(basis.N),
        np.ascontiguousarray(form.basis.element_dofs.T),
    )
    stress = np.random.default_rng(1).random(F.shape[1])
    K_e = element_stiffness(B, D)
    K = pattern.matrix(pattern.scatter(K_e))
    flat = B.reshape(n_elements, n_points * r, m)
    yield (
        "strains",
        2 * B.size,
        B.nbytes + dofs.nbytes + u.nbytes + 8 * B.size // m,
        lambda: np.matmul(flat, u.take(dofs)[:, :, None]),
    )
    yield "forces", 2 * F.nnz, 12 * F.nnz + stress.nbytes + u.nbytes, lambda: F @ stress
    yield (
        "element matrices",
        2 * B.size * (r + m),
        B.nbytes + D.nbytes + K_e.nbytes,
        lambda: element_stiffness(B, D),
    )
    yield (
        "their sum",
        K_e.size,
        K_e.nbytes + pattern.slots.nbytes + K.data.nbytes,
        lambda: pattern.scatter(K_e),
    )
    yield "product with the sum", 2 * K.nnz, 12 * K.nnz + 2 * u.nbytes, lambda: K @ u
    free = np.setdiff1d(np.arange(basis.N), sc.box_supports(basis))
    K, locations = K[free][:, free].tocsr(), basis.doflocs[:, free]
    for name, counted in FACTORS.items():
        yield name, *counted(K, locations)


FACTORS = {"factor, SuperLU": by_superlu}
try:
    import pypardiso

    FACTORS["factor, PARDISO"] = by_pardiso
except ImportError:
    pypardiso = None

# %%
# Measurements
# ------------

SIZES = {2: 80, 3: 16} if FULL else {2: 20, 3: 6}
rows = []
with threadpool_limits(1):
    rate, bandwidth = machine()
    print(f"this machine: {rate / 1e9:.1f} Gflop/s, {bandwidth / 1e9:.1f} GB/s, one thread")
    for dim, n in SIZES.items():
        for name, operations, moved, call in kernels(dim, n):
            seconds = shortest(call)
            shares = operations / seconds / rate, moved / seconds / bandwidth
            rows.append(
                {
                    "method": f"{'plane' if dim == 2 else 'space'}, {name}",
                    "n": n,
                    "seconds": seconds,
                    "Gflop": operations / 1e9,
                    "MB": moved / 1e6,
                    "of_dgemm": shares[0],
                    "of_bandwidth": shares[1],
                    "share": max(shares),
                }
            )
            print(
                f"{rows[-1]['method']:28} {1e3 * seconds:9.2f} ms  {shares[0]:6.1%} of dgemm, "
                f"{shares[1]:6.1%} of the bandwidth"
            )

# %%
# No kernel is faster than the machine, and none takes a hundred times as long as the bound. A share
# above 1 of the bandwidth means that a cache holds the data of these small bodies.

if FULL:  # other programs disturb the times of small sizes
    assert all(row["of_dgemm"] < 1.1 and row["share"] > 0.01 for row in rows)

fig, ax = plt.subplots(figsize=(7, 4), layout="constrained")
names = [row["method"] for row in rows][::-1]
ax.barh(names, [row["share"] for row in rows][::-1], color="#1f4e8c")
ax.set(xlabel="share of what the machine can do", xscale="log")
ax.axvline(1.0, color="grey", linewidth=0.8)
plt.show()

# %%
# Figures
# -------

print(json.dumps({"case": "roofline", "rate": rate, "bandwidth": bandwidth, "rows": rows}))
