"""Prose of the package, the pages and the README; and of the lint itself."""

from __future__ import annotations

import pytest

from tests import prose


def test_prose() -> None:
    """Standard terms, first words, short sentences."""
    found = prose.findings()
    assert not found, "\n".join(map(str, found))


def findings(source: str) -> list[str]:
    return [finding.word for finding in prose.Module("file.py", source).findings]


@pytest.mark.parametrize(
    "text, wrong",
    [
        ("Return the sum.", []),
        ("Whether it is zero.", ["Whether"]),
        ("Sum of two.", []),
        ("Check that the body is held?", ["?"]),
        (
            "Return `the unknowns`, ``places`` and :class:`Answers`.",
            ["Answers"],
        ),  # code, but an old name
        ("Return the unknowns.", ["unknowns"]),
        ("Round to two decimal places.", []),
        ("Wished in place.", []),
        ("Return x.\n\n    Parameters\n    ----------\n    unknowns\n        The dofs.\n    ", []),
        ("Return x.\n\n    >>> print(1)\n    what is told\n    ", []),
        ("Return x, that is not\n    there.", ["is not there"]),
    ],
)
def test_docstrings(text: str, wrong: list[str]) -> None:
    """First words, and words of the table outside code."""
    assert findings(f'def f():\n    """{text}"""\n') == wrong


def test_nouns_comments_and_messages() -> None:
    """Properties, classes and modules are named by nouns; comments and messages are prose, keys are
    none.
    """
    source = (
        '"""Sums."""\nclass A:\n    """Sum."""\n'
        '    @property\n    def s(self):\n        """Sum."""\n'
    )
    assert findings(source) == []
    assert findings("x = 1  # what the answer is") == ["answer"]
    assert findings("x = f'the pair {x} tells nothing'") == ["tells"]
    assert findings("x = {'places': 1}") == []


def test_sentences() -> None:
    """Items of lists are sentences; code, formulas and tables are not counted."""
    page = (
        "# A title\n\nTwo `a b c` words. And $x + y$ more\n- an item\n\n"
        "```python\nno prose\n```\n| a | table |\n"
    )
    assert list(prose.sentences(prose.prose_of_page(page))) == [3, 3, 2]
