"""fluxfarm-engine as a command: reports, exit codes, and bad input that is refused before any work is done."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import OpenEXR
import pytest
from conftest import ENGINE, ROOT, read_exr, render_alone

SCENE = ROOT / "scenes" / "cornell" / "scene.xml"


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([ENGINE, *map(str, arguments)], capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--size", "0x10"], "--size = 0x10"),
        (["--size", "1000000x1000000"], "at most 2^27 pixels"),
        (["--size", "ten"], "expected WxH"),
        (["--crop", "0,0,9999,1"], "expected a part of the 512x512 frame"),
        (["--spp", "-3"], "--spp"),
        (["--spp", "1.5"], "--spp"),
        (["--seconds", "-1"], "--seconds"),
        (["--spp", "4", "--seconds", "4"], "excludes"),
        (["--integrator", "magic"], 'integrator = "magic", expected auto, path'),
        (["-D", "nothing"], "expected name=value"),
        (["--threads", "0"], "--threads"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_bad_option_is_refused_by_name_and_value(options: list[str], words: str, tmp_path: Path) -> None:
    result = run("render", SCENE, "-o", tmp_path / "out.exr", *options)
    assert result.returncode == 2, result.stderr
    assert words in result.stderr + result.stdout
    assert list(tmp_path.iterdir()) == [], "something was left behind"


def test_output_that_cannot_be_written_is_refused_before_rendering(tmp_path: Path) -> None:
    result = run("render", SCENE, "-o", tmp_path / "no" / "out.exr", "--spp", "1000000")
    assert result.returncode == 2
    assert "cannot be written" in result.stderr


def test_report_says_what_the_design_promises(tmp_path: Path) -> None:
    report = tmp_path / "report.json"
    options = ("--size", "32x24", "--spp", 24, "--report", report)
    layers = render_alone(SCENE, tmp_path / "out.exr", *options)
    figures = json.loads(report.read_text())
    assert set(figures["seconds"]) == {"load", "build", "prepare", "render", "write"}
    assert figures["samples"] == 32 * 24 * 24
    assert figures["rays"] > figures["samples"]
    assert figures["rays_per_second"] == pytest.approx(figures["rays"] / figures["seconds"]["render"], rel=1e-6)
    assert set(figures["error"]) == {"noise", "bias", "unseen"}
    assert [point["spp"] for point in figures["timeline"]] == [1, 2, 4, 8, 16, 24]
    assert figures["timeline"][0]["error"] is None, "one replicate claims nothing"
    assert figures["mean"] == pytest.approx([float(layers[c].mean()) for c in "RGB"], rel=1e-4)
    assert {part["part"] for part in figures["plan"]["parts"]} >= {"next-event estimation", "tangent frames"}


def test_crop_is_the_same_part_of_the_frame(tmp_path: Path) -> None:
    options = ("--size", "48x32", "--spp", 16)
    whole = render_alone(SCENE, tmp_path / "whole.exr", *options)
    crop = render_alone(SCENE, tmp_path / "crop.exr", *options, "--crop", "10,5,20,11")
    assert crop["R"].tobytes() == whole["R"][5:16, 10:30].copy().tobytes()


@pytest.mark.parametrize("method", ["path", "photon", "photon-progressive", "irradiance-cache"])
def test_scene_names_its_method_and_an_option_another(method: str, tmp_path: Path) -> None:
    text = (ROOT / "scenes" / "cornell-glass" / "scene.xml").read_text()
    scene = tmp_path / "scene.xml"
    scene.write_text(text.replace('<integrator type="path"', f'<integrator type="{method}"'))
    assert method == "path" or scene.read_text() != text
    for options, expected in (((), method), (("--integrator", "path"), "path")):
        render_alone(scene, tmp_path / "out.exr", "--size", "16x9", "--spp", 1, *options)
        header = OpenEXR.File(str(tmp_path / "out.exr"), header_only=True).header()
        assert header["fluxfarm.integrator"] == expected


def test_image_header_names_what_made_it(tmp_path: Path) -> None:
    render_alone(SCENE, tmp_path / "out.exr", "--size", "16x16", "--spp", 8, "--seed", 3)
    header = OpenEXR.File(str(tmp_path / "out.exr"), header_only=True).header()
    assert header["fluxfarm.integrator"] == "path"
    assert header["fluxfarm.samples"] == 8
    assert header["fluxfarm.seed"] == "3"
    assert "Embree" in header["fluxfarm.engine"]
    assert header["fluxfarm.noiseInterval95"] == pytest.approx(2.364624)
    assert read_exr(tmp_path / "out.exr")["error.noise"].min() >= 0


TEXTURED = """<scene version="3.0.0">
<sensor type="perspective">
<film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film>
<transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
<emitter type="constant"><rgb name="radiance" value="1, 1, 1"/></emitter>
<shape type="rectangle"><bsdf type="diffuse"><texture type="TYPE" name="reflectance"/></bsdf></shape></scene>
"""


def loads_image_library(scene: Path, out: Path) -> bool:
    """Whether the dynamic linker opens OpenImageIO while the scene is rendered."""
    result = subprocess.run(
        [ENGINE, "render", scene, "-o", out, "--spp", "1"],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "LD_DEBUG": "files"},
    )
    assert "libembree" in result.stderr, "the linker says nothing"
    return "libOpenImageIO" in result.stderr


def test_image_library_is_opened_for_the_first_image_only(tmp_path: Path) -> None:
    scene = tmp_path / "scene.xml"
    assert not loads_image_library(SCENE, tmp_path / "out.exr")
    scene.write_text(TEXTURED.replace("TYPE", "checkerboard"))
    assert not loads_image_library(scene, tmp_path / "out.exr")
    shutil.copy(ROOT / "tests/engine/io/images/orange.jpg", tmp_path)
    bitmap = 'bitmap" name="reflectance"><string name="filename" value="orange.jpg"/></texture>'
    scene.write_text(TEXTURED.replace('TYPE" name="reflectance"/>', bitmap))
    assert loads_image_library(scene, tmp_path / "out.exr"), "twin: a scene with an image does open it"
    pixel = [float(read_exr(tmp_path / "out.exr")[c][4, 4]) for c in "RGB"]
    assert pixel == pytest.approx([0.5776, 0.1274, 0.0319], abs=0.02)
