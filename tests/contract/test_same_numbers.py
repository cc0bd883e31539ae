"""Numbers that engine and service both hold, as pixels depend on them: the passes, and the rounds of an error goal."""

import re
from pathlib import Path

import pytest

from fluxfarm.domain.goal import ERROR_TILE, FIRST_ROUND_SPP
from fluxfarm.domain.schedule import PASS_CEILING_SPP

FILM = Path(__file__).parents[2] / "engine" / "src" / "film"


@pytest.mark.parametrize(
    ("file", "name", "value"),
    [
        ("pass_schedule.h", "kMaxSamplesPerPass", PASS_CEILING_SPP),
        ("error_goal.h", "kFirstRound", FIRST_ROUND_SPP),
        ("error_goal.h", "kErrorTile", ERROR_TILE),
    ],
)
def test_engine_and_service_agree(file: str, name: str, value: int) -> None:
    assert re.findall(rf"\b{name} = (\d+);", (FILM / file).read_text()) == [str(value)]
