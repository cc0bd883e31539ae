"""What the service itself costs."""

import signal
import time
from pathlib import Path

import pytest
from farm_client import Client, ServiceProcess

from fluxfarm.cli.embedded import EmbeddedService
from fluxfarm.settings import Settings


@pytest.mark.slow
def test_two_thousand_trivial_tiles_take_under_ten_seconds(client: Client) -> None:
    started = time.monotonic()
    job = client.succeed(client.submit("fake: size 800 640\nfake: spp 1\n"))
    seconds = time.monotonic() - started
    assert job["progress"]["tiles_done"] == 2000
    print(f"2,000 tiles: {seconds:.2f} s")
    assert seconds < 10


def test_idle_service_uses_less_than_120_mib(settings: Settings) -> None:
    service = ServiceProcess(settings, workers=1)
    assert service.client is not None
    service.client.render("fake: spp 1\n")
    service.client.http.get("/v1/system")
    status = Path(f"/proc/{service.process.pid}/status").read_text()
    resident_mib = int(status.split("VmRSS:")[1].split()[0]) / 1024
    service.end(signal.SIGTERM)
    print(f"idle service: {resident_mib:.0f} MiB")
    assert resident_mib < 120


def test_embedded_service_starts_within_a_second(settings: Settings) -> None:
    started = time.monotonic()
    with EmbeddedService(settings):
        seconds = time.monotonic() - started
    print(f"embedded start: {seconds:.2f} s")
    assert seconds < 1
