"""The sum of the forms' tangents: values of any sum, places that stay."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix, random_array

from skfem_contact.sparse import Total, same_pattern, widened


def some(density: float, rng: np.random.Generator) -> csr_matrix:
    return csr_matrix(random_array((40, 40), density=density, rng=rng))


def test_sum(rng: np.random.Generator) -> None:
    """Whatever the patterns, new, old or wider, the sum is that of scipy (two or three terms:
    round-off).
    """
    total, solid = Total(), some(0.2, rng)
    contacts = [some(density, rng) for density in (0.01, 0.05, 0.0, 0.3, 0.02)]
    for contact in [*contacts, *contacts]:
        matrices = [solid, contact, solid.copy()]
        np.testing.assert_allclose(
            total.of(matrices).toarray(), sum(matrices).toarray(), rtol=1e-15
        )


def test_pattern_stays_when_contact_opens_or_entries_cancel(rng: np.random.Generator) -> None:
    """A map that was made for one sum serves for the next."""
    total, solid, contact = Total(), some(0.5, rng), some(0.02, rng)
    first = total.of([solid, contact])
    opened, cancelled = total.of([solid, csr_matrix((40, 40))]), total.of([solid, -solid])
    assert opened.indices is first.indices
    assert cancelled.indices is first.indices
    assert not cancelled.data.any()
    assert first.has_canonical_format


def test_entries_of_long_gone_contacts_are_dropped(rng: np.random.Generator) -> None:
    """The pattern does not grow for ever: zeros fill the factors like other entries."""
    total, solid = Total(), some(0.1, rng)
    for _ in range(50):
        last = total.of([solid, some(0.05, rng)])
    assert last.nnz < 1.1 * (solid.nnz + 0.05 * 1600)


def test_duplicates_count_twice() -> None:
    """A matrix in no canonical format is summed as it is meant."""
    twice = csr_matrix((np.ones(2), np.zeros(2, int), np.array([0, 2, 2])), shape=(2, 2))
    assert Total().of([twice, csr_matrix(np.eye(2))]).toarray().tolist() == [[3.0, 0.0], [0.0, 1.0]]


def test_wider_patterns_keep_the_values(rng: np.random.Generator) -> None:
    """A matrix on a wider pattern is the same; a pattern that lacks an entry is not taken."""
    solid, contact = some(0.2, rng), some(0.02, rng)
    wide = Total().of([solid, contact])
    found = widened(solid, wide)
    assert same_pattern(found, wide)
    np.testing.assert_array_equal(found.toarray(), solid.toarray())
    assert widened(wide, solid) is wide
