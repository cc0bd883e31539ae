"""The engine under farms that run Open Job Description templates: what it prints for them, and the template itself."""

import re
import signal
import subprocess
from pathlib import Path

import pytest
from conftest import ENGINE, ROOT

SCENE = ROOT / "scenes" / "cornell" / "scene.xml"
TEMPLATE = ROOT / "docs" / "openjd" / "render.yaml"


def render(image: Path, *options: str, scene: Path = SCENE) -> subprocess.CompletedProcess[str]:
    command = [ENGINE, "render", scene, "-o", image, "--size", "32x32", "--openjd", *options]
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, timeout=120)


@pytest.mark.parametrize(
    "goal", [("--spp", "32"), ("--seconds", "0.5"), ("--rel-error", "0.2")], ids=lambda goal: goal[0]
)
def test_progress_rises_to_100_when_the_image_is_there(tmp_path: Path, goal: tuple[str, str]) -> None:
    done = render(tmp_path / "a.exr", *goal)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert all(re.fullmatch(r"openjd_(progress|status): \S.*", line) for line in lines), done.stdout
    told = [float(line.split()[1]) for line in lines if line.startswith("openjd_progress:")]
    assert told == sorted(told)
    assert told[-1] == 100
    assert all(value < 100 for value in told[:-1])
    assert re.search(r"^openjd_status: error 0\.\d+, \d+ samples a pixel, \d+\.\d s$", done.stdout, re.MULTILINE)
    if goal[0] == "--spp":
        assert told == [3.1, 6.2, 12.5, 25.0, 50.0, 99.9, 100.0]


def test_failure_is_told_in_one_line_and_by_the_exit_code(tmp_path: Path) -> None:
    scene = tmp_path / "scene.xml"
    scene.write_text("<scene version='3.0.0'>\n<shape type='teapot'/></scene>")
    done = render(tmp_path / "a.exr", scene=scene)
    assert done.returncode == 2
    (line,) = done.stdout.splitlines()
    assert line.startswith("openjd_fail: ")
    assert "teapot" in line


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_end_that_a_farm_asks_for_leaves_nothing_behind(tmp_path: Path, number: signal.Signals) -> None:
    command = [ENGINE, "render", SCENE, "-o", tmp_path / "a.exr", "--spp", "1000000", "--openjd"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith("openjd_progress: ")
        process.send_signal(number)
        rest, _ = process.communicate(timeout=30)
    assert process.returncode == 130
    assert rest.splitlines()[-1].startswith("openjd_fail: ")
    assert list(tmp_path.iterdir()) == []


def test_template_asks_for_what_the_engine_has(tmp_path: Path) -> None:
    """Its own words with its parameters filled in, as a farm would run them."""
    text = TEMPLATE.read_text()
    words = re.findall(r"^ +- (\S+|\"[^\"]+\")$", text[text.index("args:") :], re.MULTILINE)
    values = {"Scene": SCENE, "Image": tmp_path / "a.exr"}
    for name, default in re.findall(r"- name: (\w+)\n    type: \w+\n    default: (\S+)", text):
        values[name] = default
    command = [re.sub(r"\"?\{\{Param\.(\w+)\}\}\"?", lambda match: str(values[match[1]]), word) for word in words]
    done = subprocess.run(
        [ENGINE, *command, "--size", "32x32"], capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "a.exr").stat().st_size > 1000
