"""A service inside this process, on a free port of the loopback, for as long as it is needed."""

import asyncio
import threading
from dataclasses import replace
from types import TracebackType

from fluxfarm.app import Server, bind, serve
from fluxfarm.settings import Settings

STOP_TIMEOUT_S = 15.0


class EmbeddedService:
    """Runs in a thread between `with` and its end; `url` is its address. Entering raises StartError."""

    def __init__(self, settings: Settings) -> None:
        self._settings = replace(settings, host="127.0.0.1")
        self._thread = threading.Thread(target=self._run, name="service", daemon=True)
        self._ready = threading.Event()
        self._server: Server | None = None
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
        if self._server is not None:
            self._server.should_exit = True
        self._thread.join(STOP_TIMEOUT_S)
        self._listening.close()

    def _run(self) -> None:
        def ready(server: Server) -> None:
            self._server = server
            self._ready.set()

        try:
            asyncio.run(serve(self._settings, self._listening, ready))
        except BaseException as error:
            self._fault = error
        finally:
            self._ready.set()
