"""A table that is kept in docs/ as a page, and as JSON beside it."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Protocol


class AsJson(Protocol):
    def as_json(self) -> dict[str, str]: ...


def page(head: str, table: Sequence[AsJson]) -> str:
    """`head` ends with the table's own: a line for each row follows."""
    lines = [" | ".join(row.as_json().values()).replace("\n", " ") for row in table]
    return head + "".join(f"| {line} |\n" for line in lines)


def write(head: str, table: Sequence[AsJson], markdown: Path) -> None:
    markdown.write_text(page(head, table))
    markdown.with_suffix(".json").write_text(json.dumps([row.as_json() for row in table], indent=1) + "\n")
