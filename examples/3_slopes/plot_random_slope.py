r"""
A slope of random strength
==========================

Undrained strength scatters, and it scatters from place to place. What is the probability that a
slope collapses? The slope of Griffiths and Fenton (2004): 1 to 2, firm ground as deep below the toe
as the slope is high, strength lognormal with a mean of :math:`0.25 \gamma H` and a coefficient of
variation of 0.5.

A factor of safety of each sample is not asked for, only whether it stands: ``sc.stands`` answers by
one equilibrium or one collapse, in a fifth of the time. A run that finds neither is not taken for a
collapse; it is decided by the curve of the load.

D. V. Griffiths, G. A. Fenton, J. Geotech. Geoenviron. Eng. 130 (2004) 507-518. The mesh and the
random field are in `random_slope.py`, which runs many samples on a cluster.
"""

# sphinx_gallery_thumbnail_number = 1

import json
import subprocess
import sys
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
import random_slope
from random_slope import log_mean, log_std, mean, model, sample, stands, strength
from scipy.stats import norm

import skfem_contact as sc
import skfem_contact.plot as plot

full = "--full" in sys.argv
n, length = 5, 0.5 * random_slope.height
samples, strata = (500, 200) if full else (20, 20)
plot.set_units("kN", "m")
begin = process_time()

# %%
# Uniform strength
# ----------------
# With the mean strength everywhere the factor of safety is 1.47. It is proportional to the
# strength: strength that is the same everywhere, whatever it is, lets the slope collapse where it
# is below its mean over 1.47. The probability of that is known.

basis, fixed, weight = model(n)
uniform = {"clay": sc.SolidForm(basis, sc.Tresca(E=1e5, nu=0.3, c=mean))}
factor = (
    sc.Model(uniform, fixed)
    .strength_reduction(weight, tolerance=0.002, certify=False, progress=False)
    .factor
)


def below(factor):
    """Probability that the strength is below its mean over a factor."""
    return norm.cdf((np.log(mean / factor) - log_mean) / log_std)


print(f"factor of safety {factor:.3f} (1.47); probability of collapse {below(1.47):.3f}")

# %%
# The runs must find the same. One strength from the middle of each of many slices of equal
# probability:

slices = (np.arange(strata) + 0.5) / strata
collapsed = [not stands(np.exp(log_mean + log_std * norm.ppf(p)), n) for p in slices]
infinite = np.mean(collapsed)
print(f"{strata} runs: {infinite:.3f}")

# %%
# A random field
# --------------
# The logarithm of the strength is a normal field, correlated over a length :math:`\theta` by
# :math:`\exp(-2 r / \theta)`. An element has the average of the logarithm over its integration
# points: the covariance matrix of these averages is taken from the points, and its Cholesky factor
# times independent normal numbers is a sample. Averages scatter less than points do, in elements of
# a fifth of the height by a tenth, and the probability of collapse depends on it as on the mesh.
#
# A sample is known by its number, which is the seed: any of them can be computed again, by any
# process. This is the first one that collapses, and the way it goes down:

rows = [sample(seed, length) for seed in range(20)]
fallen = next(row["seed"] for row in rows if not row["stands"])
c = strength(fallen, length, n)
clay = {"clay": sc.SolidForm(basis, sc.Tresca(E=1e5, nu=0.3, c=c))}
found = sc.Model(clay, fixed).limit_load(weight, progress=False)
assert found.multiplier < 1.0 + 0.01

fig, ax = plt.subplots(figsize=(7.5, 3.4), layout="constrained")
x, y = basis.mesh.p
colors = ax.tripcolor(x, y, basis.mesh.t.T, 0.25 * c / mean, cmap="YlGnBu")
ax.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title=f"Strength of sample {fallen}")
fig.colorbar(colors, label=r"$c_u / \gamma H$", shrink=0.8)

# %%
plot.mechanism(found)

# %%
# Many samples
# ------------
# A sample is a function of its seed, and returns a row of a table. What runs it many times is a
# matter of taste: a loop here, on a machine with many cores or on a cluster one of
#
# .. code-block:: python
#
#     with ProcessPoolExecutor() as pool:                                      # concurrent.futures
#         rows = list(pool.map(sample, range(500)))
#
#     rows = Parallel(n_jobs=-1)(delayed(sample)(i) for i in range(500))       # joblib
#
#     with LocalCluster(threads_per_worker=1) as cluster, Client(cluster) as client:    # Dask
#         rows = client.gather(client.map(sample, range(500)))
#
# below ``if __name__ == "__main__":``, with ``OMP_NUM_THREADS=1``. With ``--full`` Dask runs 500
# samples, and one of its workers is killed on the way: another one takes its place and its samples,
# and no row is missing.

if full:
    program = subprocess.run(
        [sys.executable, random_slope.__file__, "--samples", str(samples)],
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    dask = json.loads(program.stdout)
    rows = dask.pop("rows")
    assert [row["seed"] for row in rows] == list(
        range(samples)
    )  # none is lost with the worker, none comes twice
    print(", ".join(f"{what} {value:.3g}" for what, value in dask.items()))

failed = np.array([not row["stands"] for row in rows])
number = 1 + np.arange(len(failed))
estimate = np.cumsum(failed) / number
error = np.sqrt(estimate * (1.0 - estimate) / number)
print(
    f"correlation over half the height: {estimate[-1]:.3f} +- {error[-1]:.3f} from {len(failed)} "
    f"samples"
)

fig, ax = plt.subplots(figsize=(6.5, 4), layout="constrained")
ax.plot(number, estimate, color="#1f4e8c", label=r"$\theta = H/2$, with its standard error")
ax.fill_between(number, estimate - error, estimate + error, color="#1f4e8c", alpha=0.2, linewidth=0)
ax.axhline(infinite, color="#d55e00", label=r"$\theta = \infty$")
ax.set(xlabel="samples", ylabel="probability of collapse", xlim=(1, len(failed)), ylim=(0, 0.4))
ax.legend(frameon=False)

# %%
# Strength that varies quickly averages out along any surface of rupture, and with a factor of 1.47
# for its mean the slope stands nearly always. Where the factor for the mean is below 1, it is the
# other way round.

assert abs(factor / 1.47 - 1.0) < 0.005
assert abs(below(1.47) - 0.28) < 0.01
assert abs(infinite - below(1.47)) < 0.01 + 0.5 / strata  # a slice more or less
assert estimate[-1] + 3.0 * error[-1] < infinite
cpu = process_time() - begin
print(
    json.dumps(
        {
            "case": "random_slope",
            "rows": [
                {
                    "method": "uniform",
                    "n": n,
                    "unknowns": int(basis.N),
                    "error": abs(factor / 1.47 - 1.0),
                    "cpu_s": None,
                    "iterations": 0,
                    "factor": factor,
                    "cov": random_slope.cov,
                    "collapse": infinite,
                    "exact": float(below(1.47)),
                },
                {
                    "method": "random field",
                    "n": n,
                    "unknowns": int(basis.N),
                    "error": None,
                    "cpu_s": cpu,
                    "iterations": 0,
                    "samples": len(failed),
                    "collapse": float(estimate[-1]),
                    "standard_error": float(error[-1]),
                    **(dask if full else {}),
                },
            ],
        }
    )
)
