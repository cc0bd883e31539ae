"""Scenes at the limits of numbers: pictures stay finite and right by all methods, or the engine says why not."""

import json
from pathlib import Path

import pytest
import stress_cases
import stress_scenes
from kept_table import page, write
from stress_cases import CASES, LEAK, METHODS, Case
from stress_judge import Judge, Row, rows
from stress_table import FULL_SEEDS, FULL_SPP_FACTOR, HEAD

PAGE = Path(__file__).parents[2] / "docs" / "stability.md"


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Judge:
    return Judge(tmp_path_factory.mktemp("stress"))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_stress_is_borne(case: Case, method: str, short: Judge) -> None:
    row = short.row(case, method)
    assert not row.failed, row


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_stress_is_borne_with_more_samples(tmp_path: Path) -> None:
    table = rows(Judge(tmp_path, FULL_SEEDS, FULL_SPP_FACTOR))
    write(HEAD, table, tmp_path / "stability.md")
    assert not [row for row in table if row.failed]


# Twins: each is the stressed scene with an error that the comparison has to see.
TWINS = [
    Case("albedo 2 % too high", lambda: stress_scenes.chamber(albedo=0.612), plain=stress_scenes.chamber),
    Case("furnace of albedo 2 % too high", lambda: stress_scenes.furnace(0.51), closed=2),
    Case("slit in a dark box", stress_scenes.dark_box_with_a_slit, closed=0, tolerance=LEAK),
    Case("light 3 % too weak", lambda: stress_scenes.chamber(light=0.97e-8), plain=stress_scenes.chamber, factor=1e-8),
    Case(
        "albedo 0.998 for 0.999",
        lambda: stress_scenes.white_sphere(0.998),
        closed=stress_cases.white(0.999),
        tolerance=0.1,
    ),
    Case("harmless room", stress_scenes.chamber, refused="radius"),
    Case("warning that is not given", stress_scenes.chamber, plain=stress_scenes.chamber, warning="rounded"),
]


@pytest.mark.parametrize("twin", TWINS, ids=lambda twin: twin.name)
def test_errors_are_seen(twin: Case, short: Judge) -> None:
    methods = ("path",) if twin.name.startswith("albedo 0.998") else ("path", "irradiance-cache")
    for method in methods:
        assert short.row(twin, method).failed, method


def test_the_page_has_every_case_and_method() -> None:
    table = json.loads(PAGE.with_suffix(".json").read_text())
    assert [(row["case"], row["method"]) for row in table] == [
        (case.name, method) for case in CASES for method in METHODS
    ]
    assert not [row for row in table if row["verdict"].startswith("FAILS")]
    assert PAGE.read_text() == page(HEAD, [Row(**row) for row in table])
