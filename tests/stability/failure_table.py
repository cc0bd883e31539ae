"""The table of known failures as JSON and as a page: what the catalogue predicts, what is measured without the guard
and with it, and what "auto" does.

`python failure_table.py docs/failures.md` runs the engine's tests of these failures, which hold the figures to their
bounds, and renders the hard scenes by each method; it writes the page and the JSON beside it."""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import hard_scenes
import numpy as np
from failure_rows import HARD, METHODS, TESTED, Failure, HardScene, Row
from kept_table import write

sys.path.insert(0, str(Path(__file__).parents[1] / "render"))

from conftest import ENGINE, beauty, read_exr, relative_error

HEAD = """# Where methods fail

Failures that are known of each method, by the accuracy catalogue: what is predicted without a guard, what was measured
without it and with it, and what `--integrator auto` does. Written by
`python tests/stability/failure_table.py docs/failures.md`; `failures.json` beside it has the same rows. The engine's
tests hold the figures of all but 4.8 to their bounds in `make test`, `tests/stability` those of 4.8.

Guarded: the picture is as right as the method claims. Told: what is left is in `error.bias`, and no goal below it is
claimed. Not claimed: light is missing, and the job says so. Refused: the method does not render such a scene. Errors of
4.8 are sqrt(relMSE) of one picture of 32 x 32 pixels against its truth; those of the engine itself are those that it
claims.

| catalogue | failure | method | predicted | without guard | with guards | `auto` | ends |
|---|---|---|---|---|---|---|---|
"""


def tests_of_failures() -> dict[str, str]:
    """What the engine's tests told, by row and column."""
    told: dict[str, str] = {}
    with tempfile.TemporaryDirectory() as folder:
        for room in ("integrators", "film"):
            binary, out = ENGINE.resolve().with_name(f"test_{room}"), Path(folder) / "out.json"
            names = "*Fails44*:PhotonMapping.Blur*:PhotonProgressive.C8*:PhotonProgressive.C9*:*IrradianceFailures*"
            names += ":*RareEvents*:AuditOutcome.Keeps*"
            command = [binary, f"--gtest_filter={names}", f"--gtest_output=json:{out}"]
            subprocess.run(command, check=True, capture_output=True)
            for suite in json.loads(out.read_text())["testsuites"]:
                for test in suite["testsuite"]:
                    told |= {key: value for key, value in test.items() if key.startswith("failure ")}
    return told


def row_of(failure: Failure, told: dict[str, str]) -> Row:
    def column(name: str) -> str:
        return told.pop(f"failure {failure.key} {name}", "")

    off, on = column("off") or "nothing to leave out", column("on")
    auto = column("auto") or failure.auto
    return Row(failure.catalogue, failure.key, failure.method, failure.predicted, off, on, auto, failure.verdict)


def scene_of(hard: HardScene) -> hard_scenes.Node:
    build = hard_scenes.white_sphere if hard.name == "white_room" else getattr(hard_scenes, hard.name)
    scene: hard_scenes.Node = build(0.99) if hard.name == "white_room" else build()
    return scene


def truth_of(hard: HardScene, folder: Path) -> np.ndarray:
    if hard.name == "white_room":
        return np.full((hard_scenes.SIDE, hard_scenes.SIDE, 3), hard_scenes.white_sphere_radiance(0.99))
    image = folder / "truth.exr"
    goal = ("--spp", str(hard.truth_spp), "--seed", "10000", "--integrator", hard.truth_by)
    subprocess.run([ENGINE, "render", folder / "scene.json", "-o", image, *goal], check=True, capture_output=True)
    return beauty(read_exr(image))


def end_of(hard: HardScene, method: str, truth: np.ndarray, folder: Path) -> tuple[str, str]:
    """What a job by that method says, and the verdict."""
    image, report = folder / "image.exr", folder / "report.json"
    goal = ("--rel-error", str(hard.goal), "--integrator", method, "--report", report)
    done = subprocess.run(
        [ENGINE, "render", folder / "scene.json", "-o", image, *map(str, goal)],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        return done.stderr.strip().splitlines()[-1].removeprefix("error: "), "refused"
    said = json.loads(report.read_text())
    error = relative_error(beauty(read_exr(image)), truth)
    by = f"{said['integrator']}, " if method == "auto" else ""
    lost = [warning for warning in said["warnings"] if warning.startswith("goal not reached")]
    if lost:
        return f'{by}true error {error:.3f}, says "{lost[0]}"', "not claimed"
    return f"{by}claims {hard.goal:g}, true error {error:.3f}", "guarded" if error <= hard.goal else "FAILS"


def rows_of(hard: HardScene, told: dict[str, str]) -> list[Row]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scene.json").write_text(json.dumps(scene_of(hard)))
        truth = truth_of(hard, folder)
        ends = {method: end_of(hard, method, truth, folder) for method in METHODS}
    off = told.pop(f"failure {hard.failure} off", "nothing to leave out")
    return [
        Row("4.8", hard.failure, method, hard.predicted, off, ends[method][0], ends["auto"][0], ends[method][1])
        for method in METHODS
        if method != "auto"
    ]


def rows() -> list[Row]:
    told = tests_of_failures()
    table = [row_of(failure, told) for failure in TESTED]
    for hard in HARD:
        table += rows_of(hard, told)
    if told:
        raise SystemExit(f"no row for what the engine's tests told: {sorted(told)}")
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("markdown", type=Path)
    target: Path = parser.parse_args().markdown
    write(HEAD, rows(), target)


if __name__ == "__main__":
    main()
