"""README with absolute links, for a package index, which has no other file of the repository.

Pictures are those of the tag::

    python docs/readme_of_index.py owner/name v1.0.0
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

README = Path(__file__).parents[1] / "README.md"
#: Link of Markdown: "!" of a picture, text, and a target without scheme and anchor alone.
LINK = re.compile(r"(!?)\[([^\]]*)\]\((?![a-z]+:|#)([^)]+)\)")


def with_absolute_links(text: str, repository: str, tag: str) -> str:
    """Return a page of the repository whose links and pictures are found from anywhere.

    >>> with_absolute_links("![Pit](docs/pit.png) of the [guide](docs/guide.md)", "me/soil", "v1")
    '![Pit](https://raw.githubusercontent.com/me/soil/v1/docs/pit.png) of the \
[guide](https://github.com/me/soil/blob/v1/docs/guide.md)'
    """

    def absolute(link: re.Match[str]) -> str:
        picture, name, target = link.groups()
        root = f"https://github.com/{repository}/blob/{tag}"
        if picture:
            root = f"https://raw.githubusercontent.com/{repository}/{tag}"
        return f"{picture}[{name}]({root}/{target})"

    return LINK.sub(absolute, text)


if __name__ == "__main__":
    README.write_text(
        with_absolute_links(README.read_text(encoding="utf-8"), *sys.argv[1:3]), encoding="utf-8"
    )
