"""Runs the engine alone: pictures with their reports, ray rates, plans."""

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fluxfarm.chart.images import Image, read_exr
from fluxfarm.errors import ChartError

THREADS = 2  # as the peers' scripts have it


class Refused(Exception):
    """The engine does not render this; the text is its reason."""


@dataclass(frozen=True, slots=True)
class Run:
    """A picture and what the engine reports about it."""

    image: Image
    report: dict[str, Any]

    @property
    def seconds(self) -> float:
        """Of preparing (photons) and rendering; reading the scene, building its tree and writing are left out."""
        return run_seconds(self.report)


def run_seconds(report: dict[str, Any]) -> float:
    """Of preparing and rendering, from a report."""
    return float(report["seconds"]["prepare"] + report["seconds"]["render"])


@dataclass(frozen=True, slots=True)
class Engine:
    """The program, and a folder for what it writes."""

    program: Path
    folder: Path

    @property
    def image(self) -> Path:
        """The picture of the newest run."""
        return self.folder / "run.exr"

    def render(self, scene: Path, size: tuple[int, int] | None, *options: object) -> Run:
        """Raises Refused with the engine's own words."""
        report = self.folder / "run.json"
        output = ("-o", self.image, "--report", report, "--threads", THREADS)
        self._run("render", scene, *output, *_size(size), *options)
        return Run(read_exr(self.image), json.loads(report.read_text()))

    def embree_rays_per_second(self, scene: Path, size: tuple[int, int]) -> float:
        """Rays that bare Embree traces a second, of those that path tracing asks for."""
        told = self._run("bench", "path", scene, "--threads", THREADS, *_size(size), "--json")
        return float(json.loads(told)["embree_rays_per_second"])

    def plan(self, scene: Path) -> str:
        """What the scene contains and which parts of the engine it needs, in words."""
        return self._run("plan", scene)

    def build(self) -> str:
        """Identity of the engine: the same builds give the same pictures."""
        return str(json.loads(self._run("info", "--json"))["build"])

    def _run(self, *words: object) -> str:
        command = [str(self.program), *map(str, words)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False)
        except OSError as error:
            raise ChartError(f"{self.program}: does not run: {error.strerror}") from None
        if done.returncode != 0:
            said = [line for line in done.stderr.splitlines() if line.strip() and not line.startswith("warning: ")]
            raise Refused(
                said[-1].strip().removeprefix("error: ") if said else f"the engine ended with status {done.returncode}"
            )
        return done.stdout


def _size(size: tuple[int, int] | None) -> tuple[str, ...]:
    return () if size is None else ("--size", f"{size[0]}x{size[1]}")
