"""The service's README names everything that its code offers."""

import inspect
from dataclasses import fields
from pathlib import Path

from fluxfarm import errors
from fluxfarm.cli.commands import chart
from fluxfarm.cli.exits import EXIT_SENTENCES
from fluxfarm.domain.events import EventKind
from fluxfarm.domain.job import STATE_SENTENCES
from fluxfarm.settings import BOUNDS, CHOICES, PREFIX, Settings

README = (Path(__file__).resolve().parents[2] / "service" / "README.md").read_text()


def test_every_setting_has_a_line() -> None:
    for field in fields(Settings):
        assert f"| `{PREFIX}{field.name.upper()}` |" in README, field.name
    assert f"`{PREFIX}SERVER`" in README


def test_every_number_has_bounds_and_the_defaults_keep_them() -> None:
    for field in fields(Settings):
        default = getattr(Settings(), field.name)
        if isinstance(default, int | float):
            low, high = BOUNDS[field.name]
            assert low <= default <= high
    for name, choices in CHOICES.items():
        assert getattr(Settings(), name) in choices


def test_every_state_and_event_is_explained() -> None:
    for state, sentence in STATE_SENTENCES.items():
        assert f"| `{state}` | {sentence} |" in README, state
    for kind in EventKind:
        assert f"| `{kind}` |" in README, kind


def test_every_error_code_is_explained() -> None:
    for error in vars(errors).values():
        if isinstance(error, type) and issubclass(error, errors.FarmError):
            assert f"| `{error.code}` | {error.status} |" in README, error


def test_every_exit_code_is_explained() -> None:
    for code, sentence in EXIT_SENTENCES.items():
        assert f"| {code.value} | {sentence} |" in README, code


def test_every_option_of_chart_is_explained() -> None:
    for parameter in inspect.signature(chart).parameters.values():
        for declared in parameter.annotation.__metadata__[0].param_decls or ():
            assert f"`{declared}`" in README, declared
