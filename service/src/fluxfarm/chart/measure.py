"""All measurements on one scene: each method and peer, each seed, each budget, a run of its own."""

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from fluxfarm.chart.engine import Engine, Refused
from fluxfarm.chart.errors import flip, rel_mse
from fluxfarm.chart.images import Image
from fluxfarm.chart.options import ChartOptions
from fluxfarm.chart.others import measure_peer
from fluxfarm.chart.reference import Reference, claimed_rel_mse, find_reference
from fluxfarm.chart.scenes import ChartScene, boxed
from fluxfarm.chart.series import Point, Series, medians
from fluxfarm.errors import ChartError


@dataclass(frozen=True, slots=True)
class Measured:
    """What is known of a scene. `pictures` are those of the first seed by method and budget; `left_out` gives reasons.

    `embree_rays_per_second` is None where path tracing is not asked for or the scene has nothing to hit."""

    scene: str
    size: tuple[int, int]
    reference: Reference
    plan: str
    embree_rays_per_second: float | None
    series: list[Series] = field(default_factory=list)
    pictures: dict[str, dict[int, Image]] = field(default_factory=dict)
    left_out: dict[str, str] = field(default_factory=dict)

    def floor(self) -> list[tuple[float, float]]:
        """(seconds, relMSE) that path tracing would reach if its rays alone took time, at the rate of bare Embree."""
        rate = self.embree_rays_per_second
        path = next((series for series in self.series if series.name == "path"), None)
        if rate is None or path is None:
            return []
        seconds = medians(path, lambda run: None if run.rays is None else run.rays / rate)
        errors = medians(path, lambda run: run.rel_mse)
        return [(floor, error) for (_, floor), (_, error) in zip(seconds, errors, strict=True)]


def measure(scene: ChartScene, program: Path, options: ChartOptions, say: Callable[[str], None]) -> Measured:
    """Raises ChartError if the scene cannot be rendered at all. `say` is told what is done."""
    with tempfile.TemporaryDirectory(prefix="fluxfarm-chart-") as folder:
        engine = Engine(program, Path(folder))
        same = boxed(scene, Path(folder) / "scene") if options.peers else scene
        try:
            say(f"{scene.name}: reference")
            reference = find_reference(same, engine, options)
            plan = engine.plan(same.path)
        except Refused as refusal:
            raise ChartError(f"{scene.name}: cannot be rendered: {refusal}") from None
        rate = _ray_rate(engine, same, reference) if "path" in options.integrators else None
        measured = Measured(scene.name, reference.size, reference, plan, rate)
        for name in options.integrators:
            _keep(measured, name, partial(_measure_method, name, same, engine, reference, options), say)
        for peer in options.peers:
            _keep(measured, peer, partial(measure_peer, peer, same, reference.image, options), say)
    if not measured.series:
        raise ChartError(f"{scene.name}: nothing could be measured: {measured.left_out}")
    return measured


def _keep(
    measured: Measured,
    name: str,
    run: Callable[[], tuple[Series, dict[int, Image]]],
    say: Callable[[str], None],
) -> None:
    try:
        series, pictures = run()
    except Refused as refusal:
        measured.left_out[name] = str(refusal)
        say(f"{measured.scene}: {name} left out: {refusal}")
        return
    measured.series.append(series)
    measured.pictures[series.name] = pictures
    last = series.points[-1]
    say(f"{measured.scene}: {series.name}: relMSE {last.rel_mse:.3g}, FLIP {last.flip:.3g} after {last.seconds:.2f} s")


def _measure_method(
    name: str, scene: ChartScene, engine: Engine, reference: Reference, options: ChartOptions
) -> tuple[Series, dict[int, Image]]:
    points, pictures = [], {}
    for seed in range(options.seeds):
        for budget, seconds in enumerate(options.budgets()):
            goal = ("--integrator", name, "--seconds", seconds, "--seed", seed)
            run = engine.render(scene.path, reference.size, *goal)
            errors = rel_mse(run.image, reference.image), flip(run.image, reference.image).mean
            claimed, spp, rays = claimed_rel_mse(run.report["error"]), float(run.report["spp"]), int(run.report["rays"])
            points.append(Point(budget, seed, run.seconds, spp, *errors, claimed, rays))
            if seed == 0:
                pictures[budget] = run.image
    return Series(name, points), pictures


def _ray_rate(engine: Engine, scene: ChartScene, reference: Reference) -> float | None:
    try:
        return engine.embree_rays_per_second(scene.path, reference.size)
    except Refused:
        return None
