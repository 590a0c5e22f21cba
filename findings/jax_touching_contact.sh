#!/usr/bin/env bash
# jax 0.10.2: a contact that just touches has a quarter of its stiffness, half, or none.
#
# Expected: at a gap of exactly zero the derivatives of a penalty are the ones of one of the two
#     sides: all of the penalty or nothing, whichever way the positive part is written.
# Seen: the second derivative of 0.5 p max(-g, 0)**2 at g = 0 is 0.25 p with `jnp.maximum`,
#     `jnp.clip` and 0 with `jnp.where` and `jax.nn.relu`.  The derivative of a force p max(-g, 0)
#     is half of p.  At a gap of -1e-12 all are p.
# Meaning: matching meshes touch exactly in the first iteration.  A tangent from the energy is four
#     times too soft there, one from the force two times, and another spelling has none, so that the
#     first step of Newton's method jumps far through the other body or finds a singular matrix.
#     Start with a closed gap, or define the derivative yourself.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --no-compile --disable-pip-version-check \
    jax==0.10.2 jaxlib==0.10.2 numpy==2.4.6
cat > run.py <<'PY'
import jax
import jax.numpy as jnp

jax.config.update("jax_enable_x64", True)
positive = {
    "maximum": lambda x: jnp.maximum(x, 0.0),
    "clip": lambda x: jnp.clip(x, 0.0),
    "where": lambda x: jnp.where(x > 0, x, 0.0),
    "relu": jax.nn.relu,
}
for name, part in positive.items():
    energy = jax.grad(jax.grad(lambda gap: 0.5 * part(-gap) ** 2))
    force = jax.grad(lambda gap: -part(-gap))
    at_zero = float(energy(0.0)), float(force(0.0))
    closed = float(energy(-1e-12)), float(force(-1e-12))
    print(f"{name}: stiffness at zero gap {at_zero}, closed {closed}")
    assert closed == (1.0, 1.0)
    assert at_zero == ((0.25, 0.5) if name in ("maximum", "clip") else (0.0, 0.0))
PY
JAX_PLATFORMS=cpu OMP_NUM_THREADS=1 venv/bin/python run.py
