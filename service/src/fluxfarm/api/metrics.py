"""The service's counters in the Prometheus text format. Imported at the first scrape."""

from collections.abc import Iterator
from itertools import accumulate

from prometheus_client import CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, HistogramMetricFamily, Metric

from fluxfarm.api.deps import Services
from fluxfarm.domain.job import JobState
from fluxfarm.orchestrator.tallies import Histogram


async def exposition(farm: Services) -> str:
    """All metrics as they are now."""
    counts = await farm.ledger.counts()
    registry = CollectorRegistry()
    registry.register(_Collector(farm, counts))
    return generate_latest(registry).decode()


class _Collector:
    """Reads the tallies at the moment of the scrape."""

    def __init__(self, farm: Services, counts: dict[str, int]) -> None:
        self._farm = farm
        self._counts = counts

    def collect(self) -> Iterator[Metric]:
        """The metric families."""
        tallies = self._farm.orchestrator.tallies
        jobs = GaugeMetricFamily("fluxfarm_jobs", "Jobs by state.", labels=["state"])
        for state in JobState:
            jobs.add_metric([state], self._counts.get(state, 0))
        yield jobs
        workers = self._farm.pool.workers()
        yield GaugeMetricFamily("fluxfarm_engine_processes", "Engine processes.", len(workers))
        yield CounterMetricFamily(
            "fluxfarm_engine_restarts", "Engine processes replaced.", sum(worker.restarts for worker in workers)
        )
        yield CounterMetricFamily("fluxfarm_tiles_committed", "Tiles committed.", tallies.tiles)
        yield CounterMetricFamily("fluxfarm_tiles_stale", "Tiles refused after their lease.", tallies.stale_tiles)
        yield CounterMetricFamily("fluxfarm_revisions", "Revisions published.", tallies.revisions)
        yield _histogram("fluxfarm_tile_seconds", "Time of a tile on one thread.", tallies.tile_seconds)
        yield _histogram("fluxfarm_commit_seconds", "Time to commit a batch of tiles.", tallies.commit_seconds)
        yield _histogram("fluxfarm_queue_seconds", "Time of a job until its work begins.", tallies.queue_seconds)
        yield _histogram("fluxfarm_error_reached", "Relative error that a job ended with.", tallies.errors)
        yield CounterMetricFamily("fluxfarm_samples", "Camera samples of committed tiles.", tallies.samples)
        yield CounterMetricFamily("fluxfarm_rays", "Rays of committed tiles.", tallies.rays)


def _histogram(name: str, text: str, found: Histogram) -> Metric:
    """With cumulative buckets, as Prometheus wants them."""
    bounds = [*(f"{bound:g}" for bound in found.bounds), "+Inf"]
    buckets = list(zip(bounds, (float(count) for count in accumulate(found.counts)), strict=True))
    return HistogramMetricFamily(name, text, buckets=buckets, sum_value=found.total)
