"""``python -m tests.mutate`` changes one line of a copy of the package at a time: the tests must fail each time.

``python -m tests.mutate limit_analysis`` tries the files whose path holds a text.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
#: Seconds after which tests of a mutated package count as failed: it may iterate without end.
LONGEST = 600.0
#: For each file its tests, then the unique text and its replacement for every mutation.
MUTATIONS: dict[str, tuple[str, list[tuple[str, str]]]] = {
    "contact/laws.py": ("test_coulomb test_contact_space test_strength_contact", [
        ("self.mu * np.maximum(-normal", "1.01 * self.mu * np.maximum(-normal"),
        ("normal <= self.tension", "normal <= 1.01 * self.tension"),
        ("-direction * self.mu * by_gap", "direction * self.mu * by_gap"),
        ("returned * (along - direction", "returned * (along + direction"),
        ("mu=self.mu / factor", "mu=self.mu * factor"), ("adhesion=self.adhesion / factor", "adhesion=self.adhesion"),
        ("LawUpdate(stiffness * jump", "LawUpdate(1.01 * stiffness * jump")]),
    "contact/penalty.py": ("test_cases_friction_partial_slip test_cases_contact_patch stability", [
        ("== Status.STICK) > 0.99", "== Status.STICK) > 0.5"),
        ("after[0] = np.minimum(after[0], largest)", "after[0] = np.minimum(after[0], 1.01 * largest)")]),
    "contact/quadrature.py": ("test_cases_contact_patch test_contact_projection test_contact_space", [
        ("half = 0.5 * np.diff(cuts)", "half = 0.505 * np.diff(cuts)"),
        ("valid & (side >= 0.0)", "valid & (side <= 0.0)")]),
    "materials/elastic.py": ("test_materials_contract test_solid test_materials_element_tests", [
        ("(2 * (1 + self.nu))", "(2.02 * (1 + self.nu))"),
        ("mu[..., None, None] * np.eye(ncomp - 3)", "1.01 * mu[..., None, None] * np.eye(ncomp - 3)")]),
    "materials/drucker_prager.py": ("test_materials_contract test_materials_cones test_materials_element_tests", [
        ("constants) / (mu + 9 * bulk", "constants) / (mu + 9.09 * bulk"),
        ("mean - 3 * bulk * beta", "mean - 3.03 * bulk * beta"),
        ("excess = 3 * k.alpha", "excess = 3.03 * k.alpha"), ("9 + 3 * np.sin(psi)", "9 + 3.03 * np.sin(psi)"),
        ("alpha = self.alpha / factor", "alpha = self.alpha * factor"),
        ("strength=self.strength / factor", "strength=self.strength * factor")]),
    "materials/mohr_coulomb.py": ("test_materials_mohr_coulomb test_materials_contract test_result test_strength", [
        ("return self.c / np.tan(", "return 1.01 * self.c / np.tan("),
        ("0.5 * (largest - smallest), c", "0.505 * (largest - smallest), c"),
        ("mean * np.sin(phi), 0.0", "1.01 * mean * np.sin(phi), 0.0")]),
    "materials/hardening.py": ("test_materials_hardening", [
        ("c + way * (c_end - c)", "c + 1.01 * way * (c_end - c)"),
        ("k.phi + progress * k.phi_change", "k.phi - progress * k.phi_change"),
        ("2 * (k.c + progress", "2.02 * (k.c + progress")]),
    "water/darcy.py": ("test_water_seepage test_cases_geo_water", [
        ("0.5 - suction / width", "0.505 - suction / width"),
        ("s * s * (3.0 - 2.0 * s)", "s * s * (3.0 - 2.02 * s)"),
        ("-change * 6.0 * s", "change * 6.0 * s"),
        ("m = 1.0 - 1.0 / self.n", "m = 1.01 - 1.0 / self.n"), ("basis.N] - datum", "basis.N] + datum"),
        ("k = filled * rest**2", "k = 1.01 * filled * rest**2"),
        ('-np.einsum("eij,jeq,eq->ie"', 'np.einsum("eij,jeq,eq->ie"')]),
    "limit_analysis/certify.py": ("test_trials_bounds test_bounds_audit test_bounds", [
        ("Proof(share * theta", "Proof(1.01 * share * theta"),
        ("excess(1.0) if flow <= 1.0", "0.99 * excess(1.0) if flow <= 1.0"),
        ("fixed if live else 1.0)", "fixed if live else 1.01)"),
        ("theta * program.live\n", "0.99 * theta * program.live\n")]),
    "limit_analysis/strength.py": ("test_trials_bounds", [("np.where(found >= 1.0", "np.where(found >= 0.99")]),
    "limit_analysis/elements.py": ("test_bounds_audit test_bounds", [
        ("np.full(3, 1 / 6)", "np.full(3, 1.01 / 6)"),
        ("3 - sum(ends)] * area", "3 - sum(ends)] * 1.01 * area")]),
    "stages/run.py": ("test_stages test_stages_construction test_trials", [
        ("left = (1.0 - stage.release)", "left = (1.01 - stage.release)"),
        ("load + fraction * (end - load)", "load + 1.01 * fraction * (end - load)"),
        ("time = began + fraction", "time = began - fraction")]),
    "stages/initial.py": ("test_initial test_cases_geo_ground", [
        ("-surcharge - overburden", "surcharge - overburden"),
        ("none = ratios[elements] * vertical", "none = 1.01 * ratios[elements] * vertical"),
        ("nu=K0 / (1.0 + K0)", "nu=K0 / (1.01 + K0)"),
        ("(weights * np.diff(levels))", "(1.01 * weights * np.diff(levels))")]),
    "stages/setup.py": ("test_stages test_strength", [("return down + horizontal", "return down - horizontal")]),
}


def survives(folder: Path, file: str, tests: str, old: str, new: str) -> bool:
    """Return whether the tests of a copy of the project pass with one text replaced."""
    path = folder / "skfem_contact" / file
    original = path.read_text(encoding="utf-8")
    path.write_text(original.replace(old, new), encoding="utf-8")
    names = [f"tests/{name}" if (folder / "tests" / name).is_dir() else f"tests/{name}.py" for name in tests.split()]
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *names]
    try:
        done = subprocess.run(command, cwd=folder, env={**os.environ, "PYTHONPATH": str(folder)}, timeout=LONGEST,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip
    except subprocess.TimeoutExpired:
        return False
    finally:
        path.write_text(original, encoding="utf-8")
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{file}, {old!r}: pytest ends with status {done.returncode}, no test has failed")
    return done.returncode == 0


def main(part: str = "") -> int:
    """Try all mutations of files whose path holds a text; return 1 if a mutation survives, else 0."""
    chosen = [(file, tests, *texts) for file, (tests, all_) in MUTATIONS.items() if part in file for texts in all_]
    for file, _, old, _ in chosen:
        if (found := (ROOT / "skfem_contact" / file).read_text(encoding="utf-8").count(old)) != 1:
            raise ValueError(f"{file} holds {old!r} {found} times instead of once: choose another text")
    survivors = 0
    with tempfile.TemporaryDirectory() as name:
        shutil.copytree(ROOT, name, dirs_exist_ok=True, ignore=shutil.ignore_patterns(".*", "_build", "gallery"))
        for file, tests in dict.fromkeys((file, tests) for file, tests, *_ in chosen):
            if not survives(Path(name), file, tests, "", ""):
                raise RuntimeError(f"{file}: its tests fail without a mutation")
        for file, tests, old, new in chosen:
            alive = survives(Path(name), file, tests, old, new)
            survivors += alive
            print(f"{'SURVIVES' if alive else 'caught':9}{file}: {new}", flush=True)
    print(f"{len(chosen)} mutations, {survivors} survive")
    return int(survivors > 0)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
