"""A real service on a free port with the fake engine, and small helpers to talk to it."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from farm_client import Client, fake_engine
from hypothesis import settings as hypothesis_settings

from fluxfarm.cli.embedded import EmbeddedService
from fluxfarm.settings import Settings

# How long an example takes says more of the machine than of the code.
hypothesis_settings.register_profile("fluxfarm", deadline=None)
hypothesis_settings.load_profile("fluxfarm")


@pytest.fixture
def engine(tmp_path: Path) -> Path:
    """The fake engine as a program."""
    return fake_engine(tmp_path)


@pytest.fixture
def settings(tmp_path: Path, engine: Path) -> Settings:
    """Settings of a service in the test's own folder."""
    return Settings(data=tmp_path / "data", port=0, engine=str(engine), tile_size=16, threads=1)


@pytest.fixture
def start(settings: Settings) -> Iterator[Callable[..., Client]]:
    """Start a service with changed settings: `start(workers=2)`."""
    with ExitStack() as stack:

        def started(**changes: Any) -> Client:
            service = stack.enter_context(EmbeddedService(replace(settings, **changes)))
            client = Client(service.url)
            stack.callback(client.http.close)
            return client

        yield started


@pytest.fixture
def client(start: Callable[..., Client]) -> Client:
    """A running service with one worker."""
    return start()
