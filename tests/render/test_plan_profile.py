"""The plan against the processor: what it calls off never runs, and what it calls on does.

Each render runs under callgrind, which sees every function that the engine enters, and is small: no part depends on the
size of the picture. Needs valgrind, which the build does not install.
"""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from conftest import ENGINE, ROOT, outside_scene

# Of each part of the plan a function that runs where it is on and nowhere else. Parts that are compiled into loops of
# others, such as layers, have none.
FUNCTIONS = {
    "light-side audit": "ParticleTracer::trace(",
    "caustic map": "CausticPhotons::gather(",
    "projection map": "ProjectionMap::emit(",
    "volume map": "PhotonTracer::Group::scatter_in_medium(",
    "global map": "GlobalPhotons::estimate(",
    "irradiance cache": "OvertureBuilder::refine(",
    "environment map": "EnvmapEmitter::",
    "emitter tree": "EmitterTree::sample(",
    "media": "VolumePathGroup<",
    "textures": "::value(fluxfarm::TexturePoint const&)",
}
OWN = {name: ROOT / "scenes" / name / "scene.xml" for name in ("cornell", "cornell-glass")}
# Scene, method, and the parts of FUNCTIONS that it needs.
RUNS = {
    ("cornell", "irradiance-cache"): {"light-side audit", "irradiance cache"},
    ("cornell-glass", "photon-progressive"): {"light-side audit", "caustic map", "projection map"},
    ("cornell-box", "path"): {"light-side audit"},
    ("cornell-box", "photon"): {"light-side audit", "global map"},
    ("water-caustic", "photon-progressive"): {"light-side audit", "caustic map", "projection map"},
    ("glass-of-milk", "path"): {"media", "environment map"},
    ("veach-ajar", "path"): {"light-side audit", "textures"},
    ("veach-mis", "path"): {"light-side audit", "emitter tree"},
    ("gltf-cornell-glass", "photon-progressive"): {"caustic map", "projection map", "volume map", "media"},
}


def profile(scene: Path, method: str, folder: Path) -> tuple[dict[str, bool], set[str]]:
    """The parts of the plan, and the functions that ran."""
    calls, report = folder / "calls", folder / "report.json"
    callgrind = ("valgrind", "--tool=callgrind", f"--callgrind-out-file={calls}")
    goal = ("--integrator", method, "--rel-error", "5", "--size", "16x16", "--threads", "1")
    subprocess.run(
        [*callgrind, ENGINE, "render", scene, "-o", folder / "out.exr", "--report", report, *goal],
        check=True,
        capture_output=True,
    )
    parts = {part["part"]: part["on"] for part in json.loads(report.read_text())["plan"]["parts"]}
    functions = set(re.findall(r"^c?fn=\(\d+\) (.*)$", calls.read_text(), re.MULTILINE))
    # The linker asks for the best version of some at the start.
    return parts, {function for function in functions if "resolver" not in function}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "method"), RUNS)
def test_only_what_the_plan_calls_on_runs(name: str, method: str, tmp_path: Path) -> None:
    if shutil.which("valgrind") is None:
        pytest.skip("no profile: valgrind is not installed")
    file = "scene.glb" if name.startswith("gltf") else "scene.xml"
    parts, functions = profile(OWN[name] if name in OWN else outside_scene(name, file), method, tmp_path)
    ran = {part for part, function in FUNCTIONS.items() if any(function in each for each in functions)}
    assert ran == {part for part in FUNCTIONS if parts[part]}
    assert ran == RUNS[name, method]


def test_every_function_runs_somewhere() -> None:
    """A name that no run knows would agree with every plan that calls its part off."""
    assert set().union(*RUNS.values()) == set(FUNCTIONS)
