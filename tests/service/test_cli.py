"""The `fluxfarm` command, in processes of its own."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from farm_client import Client

from fluxfarm.settings import Settings

SCENE = "<!-- fake: size 64 48 -->\n<!-- fake: spp 8 -->\n"
COMMAND = [sys.executable, "-c", "from fluxfarm.cli import main; main()"]


@pytest.fixture
def environment(settings: Settings, tmp_path: Path) -> dict[str, str]:
    return {**os.environ, "FLUXFARM_ENGINE": settings.engine, "FLUXFARM_DATA": str(tmp_path / "cli-data")}


def run(environment: dict[str, str], *arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *map(str, arguments)], env=environment, capture_output=True, text=True, timeout=60, check=False
    )


def test_render_needs_no_service_and_leaves_only_its_images(environment: dict[str, str], tmp_path: Path) -> None:
    scene, out, png = tmp_path / "scene.xml", tmp_path / "out.exr", tmp_path / "out.png"
    scene.write_text(SCENE)
    environment["TMPDIR"] = str(tmp_path / "temporary")
    (tmp_path / "temporary").mkdir()
    done = run(environment, "render", scene, "-o", out, "--png", png, "--spp", 4)
    assert done.returncode == 0, done.stderr
    assert str(out) in done.stdout
    assert "4 samples per pixel" in done.stdout
    assert out.read_bytes()[:4] == b"\x76\x2f\x31\x01"
    assert png.read_bytes()[:4] == b"\x89PNG"
    assert list((tmp_path / "temporary").iterdir()) == []
    assert "\x1b" not in done.stderr


def test_render_with_a_service_gives_the_same_image(
    environment: dict[str, str], start: Callable[..., Client], tmp_path: Path
) -> None:
    scene = tmp_path / "scene.xml"
    scene.write_text(SCENE)
    client = start()
    for name, options in (("alone.exr", []), ("served.exr", ["--server", client.url])):
        done = run({**environment, "FLUXFARM_TILE_SIZE": "16"}, "render", scene, "-o", tmp_path / name, *options)
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "alone.exr").read_bytes() == (tmp_path / "served.exr").read_bytes()
    assert len(client.http.get("/v1/jobs").json()["jobs"]) == 1


def test_submit_watch_get_list_and_cancel_speak_to_a_service(
    environment: dict[str, str], start: Callable[..., Client], tmp_path: Path
) -> None:
    scene = tmp_path / "scene.xml"
    scene.write_text(SCENE)
    client = start()
    environment["FLUXFARM_SERVER"] = client.url
    job_id = run(environment, "submit", scene, "--name", "mine", "--size", "32x32").stdout.strip()
    watched = run(environment, "watch", job_id)
    assert (watched.returncode, "SUCCEEDED" in watched.stderr) == (0, True)
    assert run(environment, "get", job_id, "-o", tmp_path / "got.exr").returncode == 0
    assert "32x32" not in run(environment, "list").stdout
    assert "mine" in run(environment, "list").stdout
    slow = client.submit("fake: spp 64\nfake: tile_seconds 0.1\n")
    assert run(environment, "cancel", slow).stdout.strip() == "CANCELLED"
    assert run(environment, "watch", slow).returncode == 4
    assert run(environment, "watch", "nobody").returncode == 2


def test_failed_job_gives_its_reason_and_exit_code(environment: dict[str, str], tmp_path: Path) -> None:
    scene = tmp_path / "scene.xml"
    scene.write_text("<!-- fake: fail SCENE scene.xml:1: no sensor -->\n")
    done = run(environment, "render", scene, "-o", tmp_path / "out.exr")
    assert done.returncode == 1
    assert "scene.xml:1: no sensor" in done.stderr
    assert not (tmp_path / "out.exr").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["render", "nothing.xml", "-o", "out.exr"], "no such file"),
        (["render", "scene.xml", "-o", "nowhere/out.exr"], "nowhere"),
        (["render", "scene.xml", "-o", "out.exr", "--spp", "0"], "goal.spp = 0"),
        (["render", "scene.xml", "-o", "out.exr", "--spp", "4", "--seconds", "2"], "at most one"),
        (["render", "scene.xml", "-o", "out.exr", "--size", "10"], "WIDTHxHEIGHT"),
        (["render", "scene.xml", "-o", "out.exr", "--integrator", "magic"], "integrator = 'magic'"),
        (["render", "scene.xml"], "out"),
        (["dance"], "dance"),
    ],
)
def test_bad_command_line_names_what_is_wrong(
    environment: dict[str, str], tmp_path: Path, arguments: list[str], words: str
) -> None:
    (tmp_path / "scene.xml").write_text(SCENE)
    done = subprocess.run(
        [*COMMAND, *arguments], env=environment, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 2, done.stderr
    assert words in done.stderr


def test_service_that_is_not_there_and_engine_that_is_missing_exit_with_three(
    environment: dict[str, str], tmp_path: Path
) -> None:
    done = run(environment, "list", "--server", "http://127.0.0.1:9")
    assert (done.returncode, "cannot be reached" in done.stderr) == (3, True)
    scene = tmp_path / "scene.xml"
    scene.write_text(SCENE)
    done = run({**environment, "FLUXFARM_ENGINE": "/no/engine"}, "render", scene, "-o", tmp_path / "out.exr")
    assert (done.returncode, "FLUXFARM_ENGINE" in done.stderr) == (3, True)
    done = run({**environment, "FLUXFARM_WORKERS": "many"}, "serve")
    assert (done.returncode, "FLUXFARM_WORKERS = 'many'" in done.stderr) == (3, True)


def test_interrupt_cancels_the_job_and_exits_with_130(
    environment: dict[str, str], start: Callable[..., Client], tmp_path: Path
) -> None:
    scene = tmp_path / "scene.xml"
    scene.write_text("<!-- fake: spp 4096 -->\n<!-- fake: tile_seconds 0.1 -->\n")
    client = start()
    process = subprocess.Popen(
        [*COMMAND, "render", str(scene), "-o", str(tmp_path / "out.exr"), "--server", client.url],
        env=environment,
        stderr=subprocess.DEVNULL,
    )
    end = time.monotonic() + 20
    while not (jobs := client.http.get("/v1/jobs").json()["jobs"]) or jobs[0]["state"] != "RUNNING":
        assert time.monotonic() < end
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    assert process.wait(20) == 130
    assert client.job(jobs[0]["id"])["state"] == "CANCELLED"


def test_doctor_says_what_is_there_and_what_is_wrong(environment: dict[str, str]) -> None:
    done = run(environment, "doctor")
    assert done.returncode == 0, done.stdout
    assert "build fake-1" in done.stdout
    done = run({**environment, "FLUXFARM_ENGINE": "/no/engine"}, "doctor")
    assert done.returncode == 3
    assert "FAILED  engine" in done.stdout
