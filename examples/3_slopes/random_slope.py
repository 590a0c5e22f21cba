"""A slope of random strength: its model, a random field, one sample, and many of them on a cluster.

As a module it offers :func:`sample`; as a program it runs many samples on Dask (``pip install
"dask[distributed]"``)::

    OMP_NUM_THREADS=1 python random_slope.py --samples 500 --workers 2
"""

import argparse
import json
import os
import signal
import time
from functools import lru_cache

import numpy as np
from scipy.spatial.distance import cdist
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc

height, unit_weight = 10.0, 20.0
mean, cov = 0.25 * unit_weight * height, 0.5
#: Logarithms of the strength are normal, with this mean and standard deviation.
log_std = np.sqrt(np.log(1.0 + cov**2))
log_mean = np.log(mean) - 0.5 * log_std**2


@lru_cache(maxsize=1)
def model(n):
    """Basis, supports and own weight, built once in each process; n elements over the height."""
    x = np.linspace(0.0, 6.0 * height, 6 * n + 1)
    mesh = MeshTri.init_tensor(x, np.linspace(0.0, 1.0, 2 * n + 1))
    ground = np.interp(mesh.p[0], [2 * height, 4 * height], [2 * height, height])  # falls 1 to 2
    mesh = MeshTri(np.stack((mesh.p[0], ground * mesh.p[1])), mesh.t)
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    return basis, sc.box_supports(basis), sc.weight(basis, unit_weight)


@lru_cache(maxsize=2)
def root(length, n):
    """Cholesky factor of the covariance of averages over elements of a field with correlation
    exp(-2 r / length).
    """
    x = np.asarray(model(n)[0].global_coordinates())
    dim, elements, points = x.shape
    x = x.reshape(dim, -1).T
    correlation = np.exp(-2.0 * cdist(x, x) / length)
    return np.linalg.cholesky(
        correlation.reshape(elements, points, elements, points).mean(axis=(1, 3))
    )


def strength(seed, length, n):
    """Undrained strength of the elements; `length` is how far it is correlated."""
    normal = np.random.default_rng(seed).standard_normal(model(n)[0].mesh.nelements)
    return np.exp(log_mean + log_std * root(length, n) @ normal)


def stands(c, n):
    """Whether a slope with this strength, a number or one for each element, carries its weight."""
    basis, fixed, weight = model(n)
    clay = {"clay": sc.SolidForm(basis, sc.Tresca(E=1e5, nu=0.3, c=c))}
    try:
        return sc.Model(clay, fixed).is_stable(weight)
    except sc.NotConverged:  # neither: along the curve of the load, if that has an end
        found = sc.Model(clay, fixed).limit_load(weight, progress=False)
        if found.multiplier < 1.0 and not found.stop.shows_limit:
            raise
        return found.multiplier >= 1.0


def sample(seed, length=0.5 * height, n=5):
    """One sample: a row that tells what it was and what came out."""
    begin = time.perf_counter()
    return {
        "seed": seed,
        "stands": bool(stands(strength(seed, length, n), n)),
        "process": os.getpid(),
        "seconds": time.perf_counter() - begin,
    }


def many(samples, workers, kill=False):
    """Samples on Dask; rows, seconds, and seconds beside the samples as a share. A worker may be
    killed on the way.
    """
    from distributed import Client, LocalCluster, as_completed

    rows = []
    with (
        LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        client.run(sample, 0)  # every process builds its model
        begin = time.perf_counter()
        for task, row in as_completed(client.map(sample, range(samples)), with_results=True):
            rows.append(row)
            task.release()  # what has arrived need not be computed again where a worker dies
            if kill and len(rows) == samples // 10:
                os.kill(row["process"], signal.SIGKILL)
        seconds = time.perf_counter() - begin
    return rows, seconds, workers * seconds / sum(row["seconds"] for row in rows) - 1.0


def main():
    """Many samples on one worker and on several, one of which dies."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--samples", type=int, default=500)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument(
        "--timed", type=int, default=100, help="samples of the comparison with one worker"
    )
    arguments = parser.parse_args()
    alone, together = (many(arguments.timed, workers) for workers in (1, arguments.workers))
    rows, seconds, _ = many(arguments.samples, arguments.workers, kill=True)
    print(
        json.dumps(
            {
                "speed_up": alone[1] / together[1],
                "overhead": max(alone[2], together[2]),
                "seconds": seconds,
                "processes": len({row["process"] for row in rows}),
                "rows": sorted(rows, key=lambda row: row["seed"]),
            }
        )
    )


if __name__ == "__main__":  # the processes of a cluster import this file
    main()
