"""What the service itself costs."""

import time

import pytest
from conftest import Client


@pytest.mark.slow
def test_two_thousand_trivial_tiles_take_under_ten_seconds(client: Client) -> None:
    started = time.monotonic()
    job = client.succeed(client.submit("fake: size 800 640\nfake: spp 1\n"))
    seconds = time.monotonic() - started
    assert job["progress"]["tiles_done"] == 2000
    print(f"2,000 tiles: {seconds:.2f} s")
    assert seconds < 10
