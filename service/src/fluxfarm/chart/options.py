"""What a chart is asked for, checked."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from fluxfarm.errors import ChartError
from fluxfarm.peers import PYTHONS

METHODS = ("path", "photon", "photon-progressive", "irradiance-cache")
# Each half of the next.
BUDGETS = 5


@dataclass(frozen=True, slots=True)
class ChartOptions:
    """`seconds` is the longest budget of a run; `size` (width, height) in pixels, None: the scene's own.

    `reference` is an image to compare with (None: one is rendered with `reference_spp` samples a pixel). `peers` maps
    each other renderer to the Python that may have it (None: none is named). All files go to the folder `out`.
    """

    integrators: tuple[str, ...]
    peers: dict[str, str | None]
    seconds: float
    seeds: int
    size: tuple[int, int] | None
    reference: Path | None
    reference_spp: int
    out: Path

    def budgets(self) -> list[float]:
        """Seconds of the runs, doubling up to `seconds`."""
        return [self.seconds / 2**halvings for halvings in reversed(range(BUDGETS))]


def check(options: ChartOptions, scenes: Sequence[str]) -> None:
    """Raise ChartError for what cannot be measured; `scenes` are the names of the scenes."""
    for integrator in options.integrators:
        if integrator not in METHODS:
            raise ChartError(f"--integrators: {integrator!r}, expected some of {', '.join(METHODS)}")
    for peer in options.peers:
        if peer not in PYTHONS:
            raise ChartError(f"--peers: {peer!r}, expected some of {', '.join(PYTHONS)}")
    for option, value in (
        ("--seconds", options.seconds),
        ("--seeds", options.seeds),
        ("--reference-spp", options.reference_spp),
    ):
        if not value > 0 or value == float("inf"):
            raise ChartError(f"{option} = {value}: expected a number above 0")
    if not options.integrators:
        raise ChartError("--integrators: none is named, expected at least one")
    if options.reference is not None:
        if len(scenes) > 1:
            raise ChartError(f"--reference: one image, but {len(scenes)} scenes; expected one scene")
        if not options.reference.is_file():
            raise ChartError(f"--reference = {options.reference}: there is no such file, expected an OpenEXR image")
    for name in scenes:
        if list(scenes).count(name) > 1:
            raise ChartError(f"two scenes are called {name!r}; expected different names of their folders or files")
