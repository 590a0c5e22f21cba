#!/usr/bin/env bash
# ipctk 1.6.1: at the same gap, a coarse floor presses a block with half the force of a fine one.
#
# Expected: with `use_area_weighting` ("the convergent formulation"), `IMPROVED_MAX_APPROX` and the physical barrier, a
#     block 1 m wide and parallel to a wide floor feels the slope of the barrier times its width, for all meshes.
# Seen: barrier of 1 mm, gap of 0.5 mm, stiffness 1: right is 4.329.  With floor edges of 25 mm: 4.329; of 0.71 m:
#     5.257 (121 %); of 1.67 m or 5 m, without a node under the block: 2.165 (50 %).  The edges of the block, 1 m to
#     5 mm, have no influence.
# Meaning: each surface adds half of the force, by the lengths that belong to those of its nodes that are opposite to
#     the other surface.  A floor, a wall or a rigid tool of few large edges adds nothing, or too much: half of the
#     contact stiffness is missing, and a given load is carried at a smaller gap.  Refine both surfaces until edges
#     are small against the zone of contact.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    ipctk==1.6.1 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
import ipctk
import numpy as np

BARRIER, GAP, STIFFNESS = 1e-3, 5e-4, 1.0


def chain(x, height, first):
    """Points and edges of a horizontal line."""
    numbers = first + np.arange(x.size)
    return np.column_stack([x, np.full(x.size, height)]), np.column_stack([numbers[:-1], numbers[1:]])


def force(floor_parts, block_parts):
    """Vertical force on the block, and the lengths that belong to nodes of the floor under it."""
    floor_x = np.linspace(-1.98, 3.02, floor_parts + 1)  # no node is opposite to a node of the block's ends
    floor, floor_edges = chain(floor_x, 0.0, 0)
    block, block_edges = chain(np.linspace(0.0, 1.0, block_parts + 1), GAP, floor.shape[0])
    points = np.vstack([floor, block])
    mesh = ipctk.CollisionMesh(points, np.vstack([floor_edges, block_edges]), np.zeros((0, 3), int))
    pairs = ipctk.NormalCollisions()
    pairs.use_area_weighting = True
    pairs.collision_set_type = ipctk.NormalCollisions.CollisionSetType.IMPROVED_MAX_APPROX
    pairs.build(mesh, points, BARRIER)
    potential = ipctk.BarrierPotential(BARRIER, STIFFNESS, use_physical_barrier=True)
    gradient = potential.gradient(pairs, mesh, points).reshape(-1, 2)
    under = np.count_nonzero((floor_x > 0) & (floor_x < 1)) * (floor_x[1] - floor_x[0])
    return -gradient[floor.shape[0] :, 1].sum(), under


# barrier of squared distances, scaled to BARRIER times a function of the gap over the barrier, by the chain rule
slope = ipctk.barrier_first_derivative(GAP**2, BARRIER**2) * 2 * GAP
right = -STIFFNESS * slope * BARRIER / BARRIER**4
print(f"right {right:.4f} per m")
for floor_parts, block_parts, share in (
    (200, 1, 1.0),
    (200, 3, 1.0),
    (7, 16, 1.214),
    (3, 1, 0.5),
    (3, 200, 0.5),
    (1, 16, 0.5),
):
    found, under = force(floor_parts, block_parts)
    print(f"{5 / floor_parts:.3f} m of floor, {1 / block_parts:.3f} m of block: {found:.4f}, {found / right:.1%} of it")
    assert abs(found / right - share) < 1e-3
    assert abs(found / right - (1 + under) / 2) < 1e-6
PY
OMP_NUM_THREADS=1 venv/bin/python run.py
