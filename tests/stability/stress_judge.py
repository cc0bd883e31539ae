"""Renders a stressed scene with the real engine and says how it went."""

import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

import numpy as np
import stress_cases
import stress_scenes
from hard_scenes import Node
from stress_cases import Case

sys.path.insert(0, str(Path(__file__).parents[1] / "render"))

from conftest import ENGINE, beauty, read_exr

TIME_LIMIT_S = 120  # a render of these sizes takes a second or two; longer is a hang


@dataclass(frozen=True)
class Render:
    """What the engine made of a scene: a picture's mean over pixels and channels, or an error."""

    mean: float = float("nan")
    clean: bool = False  # every value is finite and none is negative
    warnings: tuple[str, ...] = ()
    error: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    case: str
    method: str
    expected: str
    measured: str
    tolerance: str
    verdict: str

    @property
    def failed(self) -> bool:
        return self.verdict.startswith("FAILS")

    def as_json(self) -> dict[str, str]:
        return asdict(self)


def render(scene: Node, method: str, size: str, spp: int, seed: int, folder: Path) -> Render:
    file, image, report = folder / "scene.json", folder / "image.exr", folder / "report.json"
    file.write_text(json.dumps(scene))
    (folder / stress_scenes.SLIVERS).write_text(stress_scenes.sliver_obj())
    options = ["--integrator", method, "--size", size, "--spp", spp, "--seed", seed, "--report", report]
    began = time.monotonic()
    try:
        done = subprocess.run(
            [ENGINE, "render", file, "-o", image, *map(str, options)],
            capture_output=True,
            check=False,
            text=True,
            timeout=TIME_LIMIT_S,
        )
    except subprocess.TimeoutExpired:
        return Render(error=f"hangs: no picture after {TIME_LIMIT_S} s", seconds=TIME_LIMIT_S)
    seconds = time.monotonic() - began
    if done.returncode != 0:
        return Render(error=f"status {done.returncode}: {done.stderr.strip()}", seconds=seconds)
    picture = beauty(read_exr(image))
    warnings = tuple(json.loads(report.read_text())["warnings"])
    clean = bool(np.isfinite(picture).all() and (picture >= 0).all())
    return Render(float(picture.mean()), clean, warnings, "", seconds)


class Judge:
    """Judges by `seeds` renders of each scene, with `spp_factor` times the samples of its case."""

    def __init__(self, folder: Path, seeds: int = 1, spp_factor: int = 1) -> None:
        self.folder, self.seeds, self.spp_factor = folder, seeds, spp_factor
        self._plain = cache(self._mean_of)

    def row(self, case: Case, method: str) -> Row:
        if case.refused:
            return self._refusal(case, method)
        renders = self._renders(case, case.scene(), method)
        for one in renders:
            if one.error:
                return self._line(case, method, "no picture", f"FAILS: {one.error}")
            if not one.clean:
                return self._line(case, method, f"{one.mean:.6g}", "FAILS: a pixel is negative or no finite number")
        mean = statistics.fmean(one.mean for one in renders)
        expected = (
            case.closed if case.plain is None else case.factor * self._plain(case.plain, method, case.size, case.spp)
        )
        assert expected is not None
        deviation = abs(mean - expected) / (abs(expected) or 1.0)
        said = " ".join(renders[0].warnings)
        if case.warning not in said:
            verdict = f"FAILS: no warning has the words {case.warning!r}"
        elif deviation <= case.tolerance:
            verdict = "right" + (", and warned" if renders[0].warnings else "")
        elif renders[0].warnings:
            verdict = f"named in a warning: {said}"
        else:
            verdict = "FAILS: wrong, and nothing says so"
        return self._line(case, method, self._measured(case, mean, expected, renders), verdict)

    def _measured(self, case: Case, mean: float, expected: float, renders: list[Render]) -> str:
        if expected == 0:
            return f"{mean:.3g}"
        text = f"{mean:.6g} ({100 * (mean / expected - 1):+.2f} %)"
        if len(renders) > 1:
            error = statistics.stdev(one.mean for one in renders) / len(renders) ** 0.5
            text += f", standard error {100 * error / expected:.2f} %"
        return text

    def _refusal(self, case: Case, method: str) -> Row:
        (one,) = self._renders(case, case.scene(), method, seeds=1)
        if not one.error:
            return self._line(case, method, f"{one.mean:.6g}", "FAILS: not refused")
        lines = one.error.splitlines()
        clear = one.error.startswith("status 2: error: ") and len(lines) == 1 and case.refused in one.error
        reason = one.error.removeprefix("status 2: error: ")
        return self._line(
            case, method, "refused", f"refused: {reason}" if clear else f"FAILS: no clear error: {one.error}"
        )

    def _renders(self, case: Case, scene: Node, method: str, seeds: int = 0) -> list[Render]:
        spp = case.spp * self.spp_factor
        return [render(scene, method, case.size, spp, seed, self.folder) for seed in range(seeds or self.seeds)]

    def _mean_of(self, plain: Callable[[], Node], method: str, size: str, spp: int) -> float:
        spp *= self.spp_factor
        return statistics.fmean(
            render(plain(), method, size, spp, seed, self.folder).mean for seed in range(self.seeds)
        )

    def _line(self, case: Case, method: str, measured: str, verdict: str) -> Row:
        tolerance = f"{case.tolerance:g}" if case.closed == 0 else f"{100 * case.tolerance:g} %"
        return Row(case.name, method, case.expected, measured, "" if case.refused else tolerance, verdict)


def rows(judge: Judge) -> list[Row]:
    return [judge.row(case, method) for case in stress_cases.CASES for method in stress_cases.METHODS]
