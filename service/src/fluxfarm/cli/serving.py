"""The body of `fluxfarm serve`."""

import asyncio
import sys

from fluxfarm import logs
from fluxfarm.app import Server, bind, serve
from fluxfarm.settings import Settings


def run(settings: Settings) -> None:
    """Serve until SIGINT or SIGTERM; prints the address on standard output once requests are answered."""
    logs.set_up(settings.log_level)
    listening = bind(settings)
    listening.listen(2048)
    host, port = listening.getsockname()[:2]

    def ready(server: Server) -> None:
        shown = f"[{host}]" if ":" in host else host
        print(f"Fluxfarm listens on http://{shown}:{port}", flush=True)
        sys.stdout.flush()

    asyncio.run(serve(settings, listening, ready))
