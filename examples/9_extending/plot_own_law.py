r"""
How to add an interface law
===========================

An interface law is a material with two components in the plane and three in space: it answers a gap
and a slip with tractions. It is a small immutable class, and a pure function: what a point
remembers are *internal variables*, which the law is given as they were accepted, and gives back as
they would be.

Two laws are written here, and each is compared with its closed form: a rough joint that dilates as
it is sheared, and a bond that is damaged until it breaks.
"""

import json
from dataclasses import dataclass
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.contact import LawUpdate
from skfem_contact.contact.laws import Status

# %%
# What a law is asked
# -------------------
# ``update(jump, internal, penalty)`` is called with the gap, negative in penetration, and the slip
# from the stick point, ``jump`` of shape (dim, n); with the accepted internal variables,
# (n_internal, n); and with the penalties, which are tractions per gap and per elastic slip. It
# answers with an ``LawUpdate`` of
#
# * ``traction``, (dim, n): a negative number presses, a positive shear drags a slave back that slid
#   forward;
# * ``internal``, the new internal variables;
# * ``tangent``, (dim, dim, n): the derivative of each traction by each component of the jump;
# * ``elastic_slip``, (dim - 1, n): the slip that is left to the stick point, which follows as the
#   point slides;
# * ``status`` of every point: open, stick or slip.
#
# ``reaches(gap, internal, closed)`` names the points for which ``update`` is asked; all others are
# open.

# %%
# A joint that dilates
# --------------------
# Asperities ride up on each other: a plastic slip :math:`\Delta\lambda` opens the joint by
# :math:`\Delta w = \tan\psi\,\Delta\lambda`, and :math:`t_N = \epsilon_N (g - w)`. The condition
# :math:`|t_T| + \mu\, t_N = 0` at the end of the step gives
#
# .. math:: \Delta\lambda = \frac{|t_T^{trial}| + \mu\, t_N^{trial}}{\epsilon_T + \mu\,\epsilon_N
#    \tan\psi} .


@dataclass(frozen=True, eq=False)
class Dilatant(sc.InterfaceLaw):
    """Coulomb friction with a constant angle of dilation in degrees; it remembers the opening by
    dilation.
    """

    mu: float
    psi: float

    n_internal = 1

    def reaches(self, gap, internal, closed):
        """Asperities touch below the opening that they have made, and ride up farther where they
        are in touch.
        """
        return (gap <= internal[0]) | closed

    def update(self, jump, internal, penalty):
        """Return in the direction of shear and dilation."""
        by_gap, by_slip = penalty
        rise, dim = np.tan(np.radians(self.psi)), len(jump)
        normal, trial = by_gap * (jump[0] - internal[0]), by_slip * jump[1:]
        size = np.linalg.norm(trial, axis=0)
        along = trial / np.where(size > 0, size, 1.0)
        plastic = np.maximum(size + self.mu * normal, 0.0) / (by_slip + self.mu * by_gap * rise)
        slides = plastic > 0

        # derivative of the plastic slip, then of what it takes from normal and shear traction
        rate = slides * np.concatenate((np.full((1, len(size)), self.mu * by_gap), by_slip * along))
        rate /= by_slip + self.mu * by_gap * rise
        tangent = np.zeros((dim, dim, len(size)))
        tangent[0] = -by_gap * rise * rate
        tangent[0, 0] += by_gap
        tangent[1:] = -by_slip * along[:, None] * rate
        kept = by_slip * (1.0 - by_slip * plastic / np.where(size > 0, size, 1.0))
        across = np.eye(dim - 1)[..., None] - along[:, None] * along
        tangent[1:, 1:] += by_slip * along[:, None] * along + kept * across

        traction = np.concatenate(
            ((normal - by_gap * rise * plastic)[None], trial - by_slip * plastic * along)
        )
        apart = traction[0] > 0
        traction[:, apart], tangent[:, :, apart], plastic[apart] = 0.0, 0.0, 0.0
        status = np.where(apart, Status.OPEN, np.where(slides, Status.SLIP, Status.STICK))
        return LawUpdate(
            traction, internal + rise * plastic, tangent, traction[1:] / by_slip, status
        )


# %%
# A bond that is damaged
# ----------------------
# The bond carries a traction that falls with the largest separation :math:`\kappa` that it has
# seen, from its strength f to zero at :math:`\delta_f = 2 G / f`, where G is the energy that it
# takes to part a unit of surface. It unloads along the secant, and pressed it stays a contact
# without friction.
#
# .. math:: t = (1 - d)\,\epsilon\,\delta, \qquad
#           d = \frac{\delta_f}{\kappa}\, \frac{\kappa - \delta_0}{\delta_f - \delta_0}, \qquad
#           \delta_0 = f / \epsilon_N, \qquad \delta = \sqrt{\langle g \rangle^2 + s^2} .


@dataclass(frozen=True, eq=False)
class Cohesive(sc.InterfaceLaw):
    """Bond with linear softening; it remembers the largest separation."""

    strength: float
    energy: float

    n_internal = 1
    bonds = True  # what lies near the master is bonded as it is meshed

    def reaches(self, gap, internal, closed):
        """What presses, and bonds that are not broken."""
        return (gap <= 0.0) | (closed & (internal[0] < 2 * self.energy / self.strength))

    def update(self, jump, internal, penalty):
        """Secant stiffness of the largest separation."""
        dim, n = jump.shape
        first, last = self.strength / penalty[0], 2 * self.energy / self.strength
        apart = np.concatenate((np.maximum(jump[:1], 0.0), jump[1:]))
        separation = np.linalg.norm(apart, axis=0)
        largest = np.maximum(np.maximum(internal[0], separation), first)
        damage = np.minimum(last * (largest - first) / (largest * (last - first)), 1.0)

        stiffness = np.array([penalty[0]] + [penalty[1]] * (dim - 1))[:, None] * np.ones(n)
        secant = (1 - damage) * stiffness
        secant[0, jump[0] <= 0] = penalty[0]
        tangent = np.eye(dim)[..., None] * secant
        grows = (separation == largest) & (separation > first) & (damage < 1)
        rate = np.where(grows, last * first / (largest**2 * (last - first)), 0.0)
        tangent -= (
            rate * (stiffness * apart)[:, None] * apart / np.where(separation > 0, separation, 1.0)
        )

        status = np.where(damage < 1, Status.STICK, np.where(jump[0] > 0, Status.OPEN, Status.SLIP))
        return LawUpdate(secant * jump, largest[None], tangent, jump[1:].copy(), status)


# %%
# Checked without a mesh
# ----------------------
# :func:`~skfem_contact.testing.check_interface_law` leads random points to random jumps, in the
# plane and in space: shapes, tangents against differences, admissibility, dissipation.

for law in (Dilatant(mu=0.5, psi=10.0), Cohesive(strength=2.0, energy=2e-3)):
    print(type(law).__name__, f"{sc.testing.check_interface_law(law):.0e}")

# %%
# The shear box
# -------------
# A block, guided so that it does not bend, is pressed on a rough plane and sheared, twice. Under a
# constant load the joint rises by :math:`\tan\psi` times the plastic slip and the shear stays
# :math:`\mu p`. With the lid held at its height, nothing can rise: the pressure grows instead,
# against the block and the penalty in series,
# :math:`1/k = H/E + 1/\epsilon`, so that
#
# .. math:: p = \frac{p_0 + k\, s \tan\psi}{1 + k\, \mu \tan\psi / \epsilon} .

E, H, p0, mu, psi, eps = 1e4, 0.5, 20.0, 0.6, 8.0, 5e6
rise = np.tan(np.radians(psi))

block = MeshQuad.init_tensor(np.linspace(0, 1, 9), np.linspace(0, H, 5)).with_defaults()
basis = Basis(block, ElementVector(ElementQuad1()), intorder=2)
along, lid = basis.nodal_dofs[0], basis.get_dofs("top").all("u^2")
plane = sc.rigid.line((-1.0, 0.0), (3.0, 0.0))
block_form = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.0))
joint = sc.ContactPair(basis, "bottom", plane, Dilatant(mu, psi), quadrature="nodal", penalty=eps)
forms = {"block": block_form, "joint": joint}
slips = np.linspace(0, 0.02, 6)
load = p0 * basis.zeros()
load[lid] = -p0 * np.array([0.5, *[1.0] * 7, 0.5]) / 8


def sheared(stage_load, held, height=0.0):
    """Stages that lead the block sideways; its lid is loaded, or held at a height."""
    stages = []
    for s in slips:
        x = basis.zeros()
        x[along], x[lid] = s, height
        stages.append(sc.Stage(f"slip {s:g}", stage_load, x))
    return list(sc.Model(forms, held).run(stages, progress=False))


def carried(stages):
    """Pressure and shear of the joint in every stage."""
    found = [stage.tractions("joint") for stage in stages]
    return np.array([(t.weight @ t.pressure, abs(t.weight @ t.shear)) for t in found]).T


begin = process_time()
free = sheared(load, along)
box_cpu = process_time() - begin
height = -p0 * (H / E + 1 / eps)
held = sheared(basis.zeros(), np.union1d(along, lid), height)

plastic = np.maximum(slips - mu * p0 / eps, 0.0)
risen = np.array([stage.x[lid].mean() for stage in free]) - free[0].x[lid].mean()
k = 1 / (H / E + 1 / eps)
grown = np.where(slips > 0, (p0 + k * slips * rise) / (1 + k * mu * rise / eps), p0)
pressure, shear = carried(held)
box_error = max(
    np.abs(risen - rise * plastic).max() / (rise * slips[-1]), np.abs(pressure / grown - 1).max()
)

np.testing.assert_allclose(carried(free)[0], p0, rtol=1e-7)
np.testing.assert_allclose(carried(free)[1][1:], mu * p0, rtol=1e-7)
np.testing.assert_allclose(shear[1:], mu * pressure[1:], rtol=1e-7)
assert box_error < 1e-6  # both are straight lines: what is left is the residual of Newton's method

# %%
# Pulled apart
# ------------
# A block is bonded to a plane and pulled off by its lid. Block and bond are in series, so that
# beyond the peak
# :math:`\sigma = (\delta_f - U) / ((\delta_f - \delta_0) / f - H / E)`. Unloaded half-way, it
# returns to the origin along the secant. In the end the work is the energy of the bond, and nothing
# else. That nothing touches any more is told.

f, G = 50.0, 1.0
first, last = f / eps, 2 * G / f
peak = f * H / E + first
half = 0.5 * (peak + last)
bond = sc.ContactPair(basis, "bottom", plane, Cohesive(f, G), quadrature="nodal", penalty=eps)
pull = np.array(
    [
        0.0,
        0.5 * peak,
        peak,
        *np.linspace(peak, half, 5)[1:],
        0.3 * half,
        half,
        *np.linspace(half, last, 5)[1:],
        1.1 * last,
    ]
)
stages = []
for number, up in enumerate(pull):
    x = basis.zeros()
    x[lid] = up
    stages.append(sc.Stage(f"{number}", basis.zeros(), x))
begin = process_time()
result = sc.Model({"block": block_form, "bond": bond}, np.union1d(along, lid)).run(
    stages, progress=False
)
bond_cpu = process_time() - begin
stress = np.array([block_form.assemble(s.x, s.states["block"]).force[lid].sum() for s in result])


def on_the_envelope(up):
    """Stress of a bond that is pulled for the first time."""
    softening = (last - up) / ((last - first) / f - H / E)
    return np.where(up <= peak, f * up / peak, np.clip(softening, 0.0, None))


exact = on_the_envelope(pull)
exact[7] = 0.3 * exact[6]  # the secant
work = np.sum(0.5 * (stress[1:] + stress[:-1]) * np.diff(pull))
bond_error = np.abs(stress - exact).max() / f
assert bond_error < 1e-6
assert abs(work / G - 1) < 1e-6

fig, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
axes[0].plot(1e3 * slips, grown, "0.7", label="exact")
axes[0].plot(1e3 * slips, pressure, "C0o", label="pressure, lid held")
axes[0].plot(1e3 * slips, shear, "C1s", label="shear, lid held")
axes[0].plot(1e3 * slips, carried(free)[1], "C2^", label="shear, constant load")
axes[0].set(xlabel="slip [mm]", ylabel="kPa", title="A joint that dilates")
axes[0].legend(frameon=False)
fine = np.linspace(0, 1.1 * last, 400)
axes[1].plot(1e3 * fine, on_the_envelope(fine), "0.7", label="exact")
axes[1].plot(1e3 * pull, stress, "C0o-", lw=0.8, label="computed")
axes[1].set(xlabel="displacement of the lid [mm]", ylabel="kPa", title="A bond that breaks")
axes[1].legend(frameon=False)

plt.show()
rows = [
    {
        "method": "dilation",
        "n": len(slips),
        "unknowns": int(basis.N),
        "error": float(box_error),
        "cpu_s": round(box_cpu, 2),
        "iterations": sum(sum(s.iterations) for s in free),
    },
    {
        "method": "damage",
        "n": len(pull),
        "unknowns": int(basis.N),
        "error": float(bond_error),
        "cpu_s": round(bond_cpu, 2),
        "iterations": sum(sum(s.iterations) for s in result),
    },
]
print(json.dumps({"case": "own interface laws", "rows": rows}))
