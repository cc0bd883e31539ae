"""Which service a command talks to, and how: one that is told, this user's own, or one inside the command."""

import gc
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fluxfarm.cli.exits import CommandError, Exit
from fluxfarm.settings import OWNER_KEY_FILE, PREFIX, Settings, from_environment

if TYPE_CHECKING:
    from fluxfarm.cli.client import ServiceClient


def changed(settings: Settings, **options: Any) -> Settings:
    """The settings with the options that were given; checked like variables of the environment."""
    given = {f"{PREFIX}{name.upper()}": str(value) for name, value in options.items() if value is not None}
    return from_environment({**os.environ, **given}) if given else settings


def connect(server: str | None) -> "ServiceClient":
    """Talks to the service that is told, else to where `fluxfarm serve` listens by default.

    The key is that of the environment; for a service of this user on this machine also the one that it made itself."""
    from fluxfarm.cli.client import ServiceClient

    settings, key = from_environment(), os.environ.get(PREFIX + "API_KEY")
    if server is not None:
        return ServiceClient(server, key)
    with suppress(OSError):
        key = key or (settings.data / OWNER_KEY_FILE).read_text().strip()
    return ServiceClient(f"http://{settings.reached_at}:{settings.port}", key)


@contextmanager
def service(server: str | None, threads: int | None, workers: int | None) -> Iterator["ServiceClient"]:
    """The service to render with; an embedded one, with a data folder that is removed, if none is told."""
    if server is not None:
        if threads is not None or workers is not None:
            raise CommandError(Exit.BAD_INPUT, "--threads and --workers are settings of the service named by --server")
        with connect(server) as client:
            yield client
        return
    from fluxfarm import logs

    with loading():
        from fluxfarm.cli.client import ServiceClient
        from fluxfarm.cli.embedded import EmbeddedService

    logs.set_up(os.environ.get(PREFIX + "LOG_LEVEL") or "critical")
    with tempfile.TemporaryDirectory(prefix="fluxfarm-", ignore_cleanup_errors=True) as folder:
        settings = changed(from_environment(), threads=threads, workers=workers)
        settings = replace(settings, data=Path(folder), port=0, sync="off", keys="off")
        with EmbeddedService(settings) as service, ServiceClient(service.url) as client:
            yield client


@contextmanager
def loading() -> Iterator[None]:
    """For slow imports: what they make stays, and looking for garbage in it costs a fifth of start and end."""
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()
