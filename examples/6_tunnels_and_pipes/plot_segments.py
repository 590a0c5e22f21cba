r"""
A lining of segments
====================

Segments of concrete meet in joints that turn: a joint of height h and width b has the rotational
stiffness :math:`b h^2 E / 12` while it is closed (Janssen 1983). ``hinges`` let the segments turn,
and ``sc.RotationSpring`` resists. A ring alone is compared with virtual work, then one in the
ground with a continuous ring. Units are kN and m.
"""

import json
from time import process_time

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import quad
from skfem import Basis, ElementTriP2, ElementVector

import skfem_contact as sc
import skfem_contact.plot as plot

sc.set_units("kN", "m")

begin = process_time()
R, h, E = 3.0, 0.3, 3.3e7
EI, EA = E * h**3 / 12, E * h
janssen = h**2 * E / 12
print(f"joints of {janssen:.3g} kNm/rad per metre, as much as {EI / janssen:.2f} m of the ring")

# %%
# A ring alone
# ------------
# A pressure :math:`p \cos 2 \theta` on a ring with four joints, at its crown, invert and sides, has
# the moments :math:`M = p R^2 \cos(2 \theta) / 3`, whatever the joints. They turn by M/k, and
# virtual work of a pair of forces at crown and invert gives the change of the diameter:
# :math:`\int M m / EI\, ds + \sum M m / k` with :math:`m = R (1 / \pi - \sin(\theta) / 2)`.

p, n = 50.0, 64  # pressure, and nodes of curved elements
angles = np.linspace(0.0, 2.0 * np.pi, n + 1)
circle = R * np.column_stack((np.sin(angles), np.cos(angles)))  # from the crown, clockwise
joints = circle[[0, 16, 32, 48]]
starts = np.arange(0, n, 2)
cells = np.column_stack((starts, (starts + 2) % n, starts + 1))  # start, end and middle


def squeezed(k):
    """Change of the vertical diameter of the ring."""
    inside = {"EI": EI, "EA": 1e4 * EI, "GA": 1e4 * EI}
    ring = sc.Beam(None, circle[:n], cells=cells, hinges=joints, **inside)
    forms = {"ring": ring, "joints": sc.RotationSpring(ring, joints, k)}
    supports = [
        *ring.dofs(circle[0], ["u^1"]),
        *ring.dofs(circle[32], ["u^1", "u^2"]),
    ]
    model = sc.Model(forms, supports)
    ring = model.forms["ring"]

    def pressure(x):
        """Force per length, inwards at the crown."""
        angle = np.arctan2(x[0], x[1])
        return -p * np.cos(2.0 * angle) * x / np.hypot(*x)

    stage = model.run([sc.Stage("pressure", ring.line_load(pressure))], progress=False)["pressure"]
    return stage.x[ring.numbers(circle[0])[1]] - stage.x[ring.numbers(circle[32])[1]]


def by_virtual_work(k):
    """The same for a thin ring without stretching and shear."""

    def work(angle):
        m = R * (1.0 / np.pi - 0.5 * abs(np.sin(angle)))
        return p * R**2 / 3.0 * np.cos(2.0 * angle) * m

    bent = 2.0 * quad(work, 0.0, np.pi)[0] * R / EI
    turned = sum(work(angle) for angle in angles[[0, 16, 32, 48]]) / k
    return -(bent + turned)


errors = []
for share in (0.1, 1.0, 10.0):
    found, exact = squeezed(share * janssen), by_virtual_work(share * janssen)
    errors.append(abs(found / exact - 1.0))
    print(f"k = {share:4} of Janssen: {1e3 * found:8.3f} mm, by virtual work {1e3 * exact:8.3f} mm")
assert max(errors) < 5e-4, errors

# %%
# A ring in the ground
# --------------------
# Eight joints in a ring that is bonded to elastic ground. The softer the joints, the less moment
# the lining attracts; thrusts stay.

outline = sc.section.circle((0.0, -15.0), R)
section = sc.section.tunnel(outline, {"clay": -35.0}, 5.0, fine=0.5, width=50.0)
basis = Basis(section.mesh(), ElementVector(ElementTriP2()), intorder=4)
clay = section.solids(basis, sc.LinearElastic(E=5e4, nu=0.3), unit_weight=19.0)
line = sc.Beam(basis, "lining", EI=EI, EA=EA)
ends = line.points[line.cells[:, 0]]
turns = np.pi / 8 + np.arange(8) * np.pi / 4
wanted = np.array([0.0, -15.0]) + R * np.column_stack((np.sin(turns), np.cos(turns)))
joints = ends[[np.argmin(np.hypot(*(ends - point).T)) for point in wanted]]


def lined(k=None):
    """Result of the tunnel with a lining of segments, or with a continuous one."""
    forms = dict(clay)
    forms["lining"] = sc.Beam(basis, "lining", EI=EI, EA=EA, hinges=joints if k else ())
    dormant = ["lining"]
    if k:
        forms["joints"] = sc.RotationSpring(forms["lining"], joints, k)
        dormant.append("joints")
    model = sc.Model(forms, sc.box_supports(basis))
    stages = [
        sc.Stage("at rest", deactivate=dormant),
        sc.Stage("lined", deactivate="core", activate=dormant),
    ]
    return model.run(stages, start=model.k0_state(K0=0.5), progress=False)["lined"]


whole = lined()
shares = [0.01, 0.1, 1.0, 10.0, 1e3]
rings = [lined(share * janssen) for share in shares]
moments = [np.abs(ring.section_forces("lining").M).max() for ring in rings]
thrusts = [-ring.section_forces("lining").N.min() for ring in rings]
forces = whole.section_forces("lining")
largest = np.abs(forces.M).max()
for share, M, N in zip(shares, moments, thrusts, strict=True):
    print(f"k = {share:6} of Janssen: M {M:6.1f} kNm/m, N {N:6.0f} kN/m")
print(f"a continuous ring:      M {largest:6.1f} kNm/m, N {-forces.N.min():6.0f} kN/m")

fig, ax = plt.subplots(figsize=(6, 3.5), layout="constrained")
ax.semilogx(shares, moments, "o-", label="segments")
ax.axhline(largest, color="k", linestyle="--", label="continuous ring")
ax.set(
    xlabel="stiffness of the joints over Janssen's", ylabel="largest moment [kNm/m]", ylim=(0, None)
)
ax.legend(frameon=False)

# %%
# Moments of the lining of segments, with joints by Janssen:

plot.diagram(rings[2].section_forces("lining"), "M", on=rings[2])

# sphinx_gallery_start_ignore
assert (np.diff(moments) > 0.0).all()
assert abs(moments[-1] / largest - 1.0) < 5e-3, moments
at_joints = rings[2].table("joints")
assert np.abs(at_joints["moment"]).max() <= moments[2] * (1 + 1e-9)
row = {
    "method": "segments",
    "n": len(ends),
    "unknowns": int(basis.N),
    "error": float(max(errors)),
    "cpu_s": round(process_time() - begin, 1),
    "iterations": None,
}
print(json.dumps({"case": "segments", "rows": [row]}))
# sphinx_gallery_end_ignore
