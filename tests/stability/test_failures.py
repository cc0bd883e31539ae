"""The kept page of known failures is whole, and what it says can be had again."""

import json
from pathlib import Path

import pytest
from failure_rows import HARD, METHODS, TESTED, Row
from failure_table import HEAD, rows
from kept_table import page

PAGE = Path(__file__).parents[2] / "docs" / "failures.md"
VERDICTS = {"guarded", "told", "not claimed", "refused"}


def unexplained(table: list[Row]) -> list[Row]:
    """Rows that miss something, or end in none of the ways in which a failure may end."""
    return [row for row in table if not all(row.as_json().values()) or row.verdict not in VERDICTS]


def kept() -> list[Row]:
    return [Row(**row) for row in json.loads(PAGE.with_suffix(".json").read_text())]


def test_the_page_has_every_failure() -> None:
    hard = [("4.8", scene.failure, method) for scene in HARD for method in METHODS if method != "auto"]
    tested = [(failure.catalogue, failure.key, failure.method) for failure in TESTED]
    assert [(row.catalogue, row.failure, row.method) for row in kept()] == tested + hard
    assert unexplained(kept()) == []
    assert PAGE.read_text() == page(HEAD, kept())


def test_a_row_without_a_reason_is_seen() -> None:
    row = kept()[0].as_json()
    assert unexplained([Row(**(row | {"on": ""}))])
    assert unexplained([Row(**(row | {"verdict": "FAILS"}))])


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_failures_end_as_the_page_says() -> None:
    table = rows()
    assert unexplained(table) == []
    assert [row.verdict for row in table] == [row.verdict for row in kept()]
