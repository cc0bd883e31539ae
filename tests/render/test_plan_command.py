"""`fluxfarm plan` and `fluxfarm-engine plan` with the real engine: the method that "auto" takes, and why."""

import base64
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import ENGINE, ROOT

COMMAND = [sys.executable, "-c", "from fluxfarm.cli import main; main()", "plan"]
AUTO = ("--integrator", "auto", "--size", "96x64")


CORNERS = base64.b64encode(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32).tobytes()).decode()
POSITION = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}
TRIANGLE = {
    "asset": {"version": "2.0"},
    "scene": 0,
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
    "materials": [{"emissiveFactor": [1, 1, 1]}],
    "accessors": [POSITION],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + CORNERS}],
}


def plan(*options: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*COMMAND, *map(str, options)], capture_output=True, text=True, check=False)


def test_plan_foretells_each_method_or_says_why_it_was_left_out() -> None:
    choice = json.loads(plan("cornell-glass", *AUTO, "--rel-error", 0.05, "--json").stdout)["choice"]
    methods = {method["method"]: method for method in choice["methods"]}
    assert set(methods) == {"path", "photon-progressive", "irradiance-cache", "photon"}
    assert choice["goal"] == {"rel_error": 0.05}
    for method in methods.values():
        if method["tried"]:
            assert method["error"] <= 0.05
            assert method["samples"] >= 16
            assert method["work"] > 0 < method["seconds"]
        else:
            assert len(method["reason"]) > 10
    assert methods["path"]["work"] > 2 * methods["photon-progressive"]["work"], "paths do not find small lamps in glass"
    assert choice["seconds"] < choice["expected_seconds"]


def test_words_are_those_of_the_engine() -> None:
    scene, goal = ROOT / "scenes" / "cornell" / "scene.xml", ("--spp", "64")
    told = plan("cornell", *AUTO, *goal).stdout
    assert "integrator: irradiance-cache\nchosen for: least squared error times work: path has " in told
    assert "photon-progressive     left out: no light reaches a surface by mirrors, glass or gloss" in told
    alone = subprocess.run([ENGINE, "plan", scene, *AUTO, *goal], capture_output=True, text=True, check=True).stdout
    without_clock = [line for line in told.splitlines() if " in about " not in line]
    assert without_clock == [line for line in alone.splitlines() if " in about " not in line]


def test_a_method_that_is_named_is_not_chosen() -> None:
    told = json.loads(plan("cornell", "--integrator", "photon-progressive", "--json").stdout)
    assert told["integrator"] == "photon-progressive"
    assert "choice" not in told


CAUSTICS = {"caustic map", "projection map"}


@pytest.mark.parametrize(
    ("scene", "method", "parts"),
    [
        ("cornell", "path", set()),
        ("cornell", "photon-progressive", set()),
        ("cornell", "photon", {"global map"}),
        ("cornell", "irradiance-cache", {"irradiance cache"}),
        ("cornell-glass", "path", set()),
        ("cornell-glass", "photon-progressive", CAUSTICS),
        ("cornell-glass", "photon", CAUSTICS | {"global map"}),
        ("cornell-glass", "irradiance-cache", CAUSTICS | {"irradiance cache"}),
    ],
)
def test_plan_has_the_maps_that_the_method_makes_of_the_scene(scene: str, method: str, parts: set[str]) -> None:
    told = {part["part"]: part for part in json.loads(plan(scene, "--integrator", method, "--json").stdout)["parts"]}
    maps = {"caustic map", "projection map", "volume map", "global map", "irradiance cache"}
    assert {name for name in maps if told[name]["on"]} == parts
    assert told["volume map"]["reason"] == f"{method} makes none of this scene"


def test_gltf_has_no_method_of_its_own_so_one_is_chosen(tmp_path: Path) -> None:
    scene = tmp_path / "triangle.gltf"
    scene.write_text(json.dumps(TRIANGLE))
    assert "choice" in json.loads(plan(scene, "--json", "--rel-error", 0.1, "--size", "32x32").stdout)
    assert "choice" not in json.loads(plan(scene, "--json", "--integrator", "path").stdout)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("cornell", "--integrator", "magic"), 'integrator = "magic", expected auto, path'),
        (("cornell", "--spp", 4, "--seconds", 4), "at most one of --rel-error, --spp and --seconds"),
        (("nowhere.xml",), "nowhere.xml: there is no such file"),
        (("nowhere",), "nowhere: expected a scene file or a built-in name"),
        (("cornell", "--crop", "0,0,9999,1"), "expected a part of the 512x512 frame"),
    ],
    ids=str,
)
def test_bad_input_is_one_error(options: tuple[object, ...], words: str) -> None:
    result = plan(*options)
    assert result.returncode == 2
    assert words in result.stderr
    assert result.stderr.count("\n") == 1
