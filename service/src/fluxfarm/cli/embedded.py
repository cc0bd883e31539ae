"""A service inside this process, on a free port of the loopback, for as long as it is needed.

It serves one command only: when that has what it came for, the service is cancelled rather than drained.
"""

import asyncio
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from types import TracebackType

from fluxfarm.app import bind, serve
from fluxfarm.settings import Settings

STOP_TIMEOUT_S = 15.0


class EmbeddedService:
    """Runs in a thread between `with` and its end; `url` is its address. Entering raises StartError."""

    def __init__(self, settings: Settings) -> None:
        self._settings = replace(settings, host="127.0.0.1")
        self._thread = threading.Thread(target=self._run, name="service", daemon=True)
        self._ready = threading.Event()
        self._cancel: Callable[[], object] = lambda: None
        self._fault: BaseException | None = None
        self.url = ""

    def __enter__(self) -> "EmbeddedService":
        self._listening = bind(self._settings)
        # Requests sent before the service is up wait in the socket's queue.
        self._listening.listen(128)
        self.url = f"http://127.0.0.1:{self._listening.getsockname()[1]}"
        self._thread.start()
        self._ready.wait()
        if self._fault is not None:
            raise self._fault
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._cancel()
        self._thread.join(STOP_TIMEOUT_S)
        self._listening.close()

    def _run(self) -> None:
        try:
            asyncio.run(self._serve())
        except BaseException as error:
            self._fault = error
        finally:
            self._cancel = lambda: None
            self._ready.set()

    async def _serve(self) -> None:
        task, loop = asyncio.current_task(), asyncio.get_running_loop()
        assert task is not None
        self._cancel = lambda: loop.call_soon_threadsafe(task.cancel)
        with suppress(asyncio.CancelledError):
            await serve(self._settings, self._listening, lambda _: self._ready.set())
