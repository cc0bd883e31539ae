"""A farm as its owner would start it: certificates, a scheduler, workers and a service, each a process of its own."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from farm_client import Client

COMMAND = [sys.executable, "-c", "from fluxfarm.cli import main; main()"]


Node = subprocess.Popen[str]


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Nodes:
    """A scheduler and what joined it, all on this machine with TLS; ends with `close`."""

    def __init__(self, folder: Path, engine: Path, host: str = "127.0.0.1", **settings: object) -> None:
        self.folder = folder
        self.certificates = folder / "certificates"
        subprocess.run([*COMMAND, "certificates", str(self.certificates)], check=True, stdout=subprocess.DEVNULL)
        self.address = f"tls://{host}:{free_port()}"
        self.environment = {
            **os.environ,
            "FLUXFARM_ENGINE": str(engine),
            "FLUXFARM_THREADS": "1",
            "FLUXFARM_SCHEDULER": self.address,
            "FLUXFARM_CERTIFICATES": str(self.certificates),
            **{f"FLUXFARM_{name.upper()}": str(value) for name, value in settings.items()},
        }
        self.scheduler = self.start("scheduler")
        first_line(self.scheduler)
        self.workers: list[Node] = []
        self.service: Node | None = None
        self.client: Client | None = None

    def start(self, *words: str, inside: Sequence[str] = (), **changes: object) -> Node:
        """Start a node, by the command `inside` if one is given; `first_line` waits for it."""
        environment = self.environment | {f"FLUXFARM_{name.upper()}": str(value) for name, value in changes.items()}
        log = (self.folder / f"{words[0]}.log").open("a")
        with log:
            return Node([*inside, *COMMAND, *words], env=environment, stdout=subprocess.PIPE, stderr=log, text=True)

    def add_worker(self, inside: Sequence[str] = (), **changes: object) -> None:
        folder = self.folder / f"worker-{len(self.workers)}"
        self.workers.append(self.start("worker", "--data", str(folder), inside=inside, **changes))

    def serve(self) -> Client:
        """Start the service, or start it again on the same data."""
        data = str(self.folder / "data")
        self.service = self.start("serve", "--backend", "dask", "--data", data, "--port", "0")
        self.client = Client(first_line(self.service).split()[-1])
        return self.client

    def kill_service(self) -> None:
        assert self.service is not None
        assert self.client is not None
        self.client.http.close()
        end(self.service, signal.SIGKILL)

    def restart_scheduler(self) -> None:
        end(self.scheduler, signal.SIGKILL)
        self.scheduler = self.start("scheduler")

    def wait_for(self, done: Callable[[list[dict[str, Any]]], bool], timeout_s: float = 40) -> list[dict[str, Any]]:
        """The workers of the farm, without the process of the service, once `done` says so of them."""
        assert self.client is not None
        limit = time.monotonic() + timeout_s
        while True:
            workers = [w for w in self.client.http.get("/v1/workers").json()["workers"] if w["host"]]
            if done(workers):
                return workers
            assert time.monotonic() < limit, workers
            time.sleep(0.1)

    def wait_for_ready(self, count: int) -> None:
        self.wait_for(lambda workers: sum(w["state"] in ("READY", "WORKING") for w in workers) == count)

    def close(self) -> None:
        if self.client is not None:
            self.client.http.close()
        for node in (self.service, *self.workers, self.scheduler):
            if node is not None:
                end(node, signal.SIGTERM)


def first_line(node: Node) -> str:
    assert node.stdout is not None
    return node.stdout.readline()


def end(node: Node, number: int) -> None:
    if node.poll() is None:
        node.send_signal(signal.SIGCONT)
        node.send_signal(number)
    try:
        node.wait(20)
    except subprocess.TimeoutExpired:
        node.kill()
        node.wait()
    if node.stdout is not None:
        node.stdout.close()
