"""The service as the commands see it: calls that return JSON or raise a CommandError with the right exit code."""

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx2

from fluxfarm.cli.bundle import LocalBundle
from fluxfarm.cli.exits import CommandError, Exit
from fluxfarm.settings import PREFIX

TRIES = 3


class ServiceClient:
    """Talks to the service at `url`, with an API key where it asks for one."""

    def __init__(self, url: str, key: str | None = None) -> None:
        self.url = url.rstrip("/")
        # Reading the system's certificates takes 0.1 s.
        verify = not self.url.startswith("http://")
        headers = {"Authorization": f"Bearer {key}"} if key else {}
        timeout = httpx2.Timeout(90.0, connect=10.0)
        self._http = httpx2.Client(base_url=self.url, timeout=timeout, verify=verify, headers=headers)

    def __enter__(self) -> "ServiceClient":
        return self

    def __exit__(self, *_: object) -> None:
        self._http.close()

    # ---- verbs ----

    def upload(self, bundle: LocalBundle) -> dict[str, str]:
        """Send the files that the service does not have; returns path -> SHA-256."""
        digests = bundle.digests()
        reply = self.call("POST", "/v1/assets:missing", json={"sha256": sorted(set(digests.values()))})
        places = {sha256: bundle.files[path] for path, sha256 in digests.items()}
        for sha256 in reply["missing"]:
            self.call("PUT", f"/v1/assets/{sha256}", content=places[sha256].read_bytes())
        return digests

    def submit(self, body: dict[str, Any], key: str) -> dict[str, Any]:
        """Submit a job; a lost reply is asked for again, which cannot make a second job."""
        job: dict[str, Any] = self.call("POST", "/v1/jobs", json=body, headers={"Idempotency-Key": key})
        return job

    def download(self, path: str, target: Path) -> None:
        """Write what is at `path` to the file `target`, whole or not at all."""
        temporary = target.with_name(f".{target.name}.{os.getpid()}.part")
        try:
            with self._reaching(), self._http.stream("GET", path) as reply:
                if reply.status_code != 200:
                    reply.read()
                    raise _refusal(reply)
                with temporary.open("wb") as file:
                    for chunk in reply.iter_bytes(1 << 20):
                        file.write(chunk)
            temporary.replace(target)
        except OSError as error:
            raise CommandError(Exit.BAD_INPUT, f"{target}: cannot be written: {error.strerror}") from None
        finally:
            temporary.unlink(missing_ok=True)

    def call(self, method: str, path: str, **arguments: Any) -> Any:
        """One call; returns its JSON, or None if the reply has no body."""
        for left in reversed(range(TRIES)):
            try:
                with self._reaching():
                    reply = self._http.request(method, path, **arguments)
            except CommandError:
                if left == 0:
                    raise
                time.sleep(0.3)
                continue
            if reply.is_error:
                raise _refusal(reply)
            return reply.json() if reply.content else None
        raise AssertionError("unreachable")

    def healthy(self) -> str | None:
        """None if the service can render, else why not."""
        with self._reaching():
            reply = self._http.get("/healthz")
        return None if reply.is_success else str(reply.json().get("status"))

    @contextmanager
    def _reaching(self) -> Iterator[None]:
        try:
            yield
        except httpx2.HTTPError as error:
            why = f"{self.url}: the service cannot be reached: {error}; start one with `fluxfarm serve`"
            raise CommandError(Exit.UNREACHABLE, why) from None


def _refusal(reply: httpx2.Response) -> CommandError:
    """A problem reply as an error of the command."""
    try:
        detail = str(reply.json().get("detail"))
    except ValueError:
        detail = f"status {reply.status_code}"
    if reply.status_code == 401:
        detail += f"; set {PREFIX}API_KEY"
    return CommandError(Exit.BAD_INPUT if reply.status_code < 500 else Exit.UNREACHABLE, detail)
