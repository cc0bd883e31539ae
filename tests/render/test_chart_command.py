"""`fluxfarm chart` with the real engine: its figures and files."""

import json
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest
from conftest import beauty, read_exr

from fluxfarm.chart.series import slope

COMMAND = [sys.executable, "-c", "from fluxfarm.cli import main; main()"]
SIZE = "24x16"
SECONDS = 0.4
SPP = 4096


def chart(out: Path, *options: object) -> dict[str, Any]:
    """chart.json's entry of cornell."""
    fixed = ("chart", "cornell", "--seconds", SECONDS, "--seeds", 1, "-o", out)
    subprocess.run([*COMMAND, *map(str, (*fixed, *options))], check=True, capture_output=True)
    (scene,) = json.loads((out / "chart.json").read_text())["scenes"]
    return dict(scene)


def slope_over_samples(scene: dict[str, Any]) -> float:
    """Of relMSE over samples a pixel, which other work on the machine does not change; of path tracing."""
    found = slope([(point["spp"], point["rel_mse"]) for point in scene["methods"][0]["points"]])
    assert found is not None
    return found


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    out = tmp_path_factory.mktemp("chart")
    return out, chart(out, "--integrators", "path,photon", "--size", SIZE, "--reference-spp", SPP)


def test_chart_has_every_run_and_file(first: tuple[Path, dict[str, Any]]) -> None:
    out, scene = first
    assert [method["name"] for method in scene["methods"]] == ["path", "photon"]
    for method in scene["methods"]:
        assert [(point["budget"], point["seed"]) for point in method["points"]] == [(i, 0) for i in range(5)]
        assert all(point["rel_mse"] > 0 and 0 < point["flip"] < 1 for point in method["points"])
    assert len(scene["floor"]) == 5
    path = scene["methods"][0]["points"]
    assert all(floor < point["seconds"] for (floor, _), point in zip(scene["floor"], path, strict=True))
    ET.parse(out / "cornell.svg")
    assert (out / "cornell.png").read_bytes()[:4] == b"\x89PNG"
    assert (out / "index.html").is_file()


def test_path_tracing_falls_as_samples_do_and_another_picture_does_not(
    first: tuple[Path, dict[str, Any]], tmp_path: Path
) -> None:
    """-1 for independent samples, a little steeper for ours. The twin: a reference of another brightness."""
    out, scene = first
    assert -1.5 < slope_over_samples(scene) < -0.75
    (reference,) = (out / "references").glob("*.exr")
    pixels = (1.5 * beauty(read_exr(reference))).astype(np.float32)
    wrong = tmp_path / "wrong.exr"
    with OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": pixels}) as file:
        file.write(str(wrong))
    other = chart(tmp_path / "out", "--integrators", "path", "--reference", wrong)
    assert other["size"] == [24, 16]
    assert other["reference"] == {"origin": "wrong.exr", "rel_mse": None}
    assert slope_over_samples(other) > -0.5


def test_reference_is_kept_for_the_next_time(first: tuple[Path, dict[str, Any]]) -> None:
    out, scene = first
    (reference,) = (out / "references").glob("*.exr")
    written = reference.stat().st_mtime_ns
    again = chart(out, "--integrators", "photon", "--size", SIZE, "--reference-spp", SPP, "--seconds", 0.1)
    assert reference.stat().st_mtime_ns == written
    assert again["reference"] == scene["reference"]
    assert again["floor"] == [], "of path tracing alone"
    chart(out, "--integrators", "photon", "--size", SIZE, "--reference-spp", 64, "--seconds", 0.1)
    assert len(list((out / "references").glob("*.exr"))) == 2


def test_scene_that_a_method_refuses_is_charted_without_it(tmp_path: Path) -> None:
    scene = tmp_path / "fog.xml"
    scene.write_text(
        """<scene version="3.0.0"><sensor type="perspective"/><emitter type="constant"/>
        <shape type="sphere"><medium name="interior" type="homogeneous"><rgb name="sigma_t" value="1, 1, 1"/></medium>
        <bsdf type="null"/></shape></scene>"""
    )
    out = tmp_path / "out"
    options = ("--integrators", "irradiance-cache,path", "--seconds", "0.2", "--seeds", "1", "--reference-spp", "16")
    command = [*COMMAND, "chart", str(scene), *options, "--size", "16x16", "-o", str(out)]
    subprocess.run(command, check=True, capture_output=True)
    (record,) = json.loads((out / "chart.json").read_text())["scenes"]
    assert [method["name"] for method in record["methods"]] == ["path"]
    assert "media" in record["left_out"]["irradiance-cache"]
    assert "left out: irradiance-cache" in (out / "fog.svg").read_text()


def test_scene_that_cannot_be_rendered_is_one_clear_error(tmp_path: Path) -> None:
    scene = tmp_path / "bad.xml"
    scene.write_text('<scene version="3.0.0"><shape type="teapot"/></scene>')
    command = [*COMMAND, "chart", str(scene), "-o", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "bad: cannot be rendered" in done.stderr
    assert "teapot" in done.stderr
