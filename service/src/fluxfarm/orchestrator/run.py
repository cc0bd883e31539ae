"""The part of an unfinished job that lives in memory: which tiles are pending, leased and done.

No input or output here: the orchestrator tells a run what happened and asks it what to do next. Everything in it can
be rebuilt from the ledger.
"""

from collections import deque
from dataclasses import dataclass, field
from pathlib import Path

from fluxfarm.domain.goal import (
    UNBOUNDED_SPP,
    Measured,
    Stop,
    ceiling_spp,
    first_round,
    has_barriers,
    next_pass,
    settled,
)
from fluxfarm.domain.job import JobState
from fluxfarm.domain.leases import Decision, RenderLease, SceneRef
from fluxfarm.domain.records import JobRecord, OpenedPass, Revision, SceneFacts, Unmerged
from fluxfarm.domain.schedule import Round, SampleRange
from fluxfarm.domain.tiles import TileGrid

# Passes that may be under way at a time.
MOST_OPEN_PASSES = 4
MOST_TILES_IN_A_LEASE = 512
# Passes whose tiles are kept before a film takes their place: a film is as much to write and read as two passes.
PASSES_TO_A_FILM = 8
# Weight of the newest tile in the running mean of the cost.
COST_WEIGHT = 0.2
# After a merge that took a second, the next one waits this many seconds: watching costs a small, fixed share.
MERGE_PAUSE = 32.0


@dataclass(slots=True)
class PassRun:
    """One pass under way. Every tile is in exactly one of pending, leased and done."""

    index: int
    samples: SampleRange
    pending: deque[int]
    leased: set[int] = field(default_factory=set)
    done: dict[int, str] = field(default_factory=dict)

    @property
    def complete(self) -> bool:
        """Whether every tile is committed."""
        return not self.pending and not self.leased

    def tiles(self) -> tuple[str, ...]:
        """Digests of the committed tiles, in the order of merging."""
        return tuple(self.done[tile] for tile in sorted(self.done))


class JobRun:
    """An unfinished job. Times are in seconds of one monotonic clock, given by the caller as `now`."""

    def __init__(self, record: JobRecord, scene: SceneRef) -> None:
        self.id = record.id
        self.request = record.request
        self.created_at = record.created_at
        self.scene = scene
        self.state = record.state
        self.crashes = record.crashes
        self.facts: SceneFacts | None = None
        # The lease that prepares the scene or merges a pass; there is at most one of them at a time.
        self.single_lease: int | None = None
        self._grid: TileGrid | None = None
        self._goal = record.request.goal
        self._passes: dict[int, PassRun] = {}
        self._leases: dict[int, RenderLease] = {}
        self._in_flight: dict[int, int] = {}
        self._opened = record.passes_opened
        self._merged_passes = 0 if record.newest is None else record.newest.passes
        # The round under way and the samples per pixel that its passes have come to; None when no more are needed.
        self._round: Round | None = None
        self._spp = 0
        self._samples = record.samples_done
        self.samples_expected: float | None = None
        # The newest film and, in the order of merging, the tiles of passes that are merged but not in it.
        self.film: str | None = None
        self.loose_tiles: tuple[str, ...] = ()
        self._loose_passes = 0
        self._newest = record.newest
        self._stop: Stop | None = None
        self._running_before = record.running_s
        self._running_since: float | None = None
        self._cost_s: float | None = None
        self._next_merge = 0.0

    # ---- verbs ----

    def start(self, facts: SceneFacts, grid: TileGrid, unmerged: Unmerged | None, now: float) -> None:
        """The scene is known: begin, or go on from what the ledger holds."""
        self.state = JobState.RUNNING
        self.facts, self._grid = facts, grid
        self.scene = self.scene.with_method(facts.integrator)
        self._goal = settled(self.request.goal, facts.scene_spp)
        self._round = first_round(self._goal, self.request.limits)
        self._running_since = now
        if unmerged is None:
            return
        self.film = unmerged.film
        loose = [tile for tile in unmerged.tiles if tile.pass_index < self._merged_passes]
        self.loose_tiles = tuple(tile.sha256 for tile in loose)
        self._loose_passes = len({tile.pass_index for tile in loose})
        if unmerged.decision is not None:
            self._begin_round(unmerged.decision)
        self._spp = self._spp if unmerged.round_spp is None else unmerged.round_spp
        for opened in unmerged.passes:
            work = self._add_pass(opened)
            work.done = {tile.tile: tile.sha256 for tile in unmerged.tiles if tile.pass_index == opened.index}
            work.pending = deque(tile for tile in work.pending if tile not in work.done)

    def open_pass(self, now: float) -> OpenedPass | None:
        """Open the next pass if its time has come; None if not, or if the job has its samples (see `warning`)."""
        if self._stop is not None or self._grid is None or any(p.pending for p in self._passes.values()):
            return None
        if self._is_decision_due:
            return None
        barriers = has_barriers(self._goal, self.request.limits)
        open_passes = len(self._passes) if barriers else sum(not p.complete for p in self._passes.values())
        if open_passes >= (1 if barriers else MOST_OPEN_PASSES):
            return None
        newest = self._newest
        measured = Measured(
            self._round,
            self._spp,
            self.running_s(now),
            self._sample_s(now),
            error_noise=None if newest is None else newest.error_noise,
            error_bound=None if newest is None else newest.error_bound,
            unseen_warning=None if newest is None else newest.unseen_warning,
        )
        samples = next_pass(self._goal, self.request.limits, measured)
        if isinstance(samples, Stop):
            self._stop = samples
            return None
        assert self._round is not None
        opened = OpenedPass(self._merged_passes + len(self._passes), samples, self._round.tiles)
        self._add_pass(opened)
        self._opened = opened.index + 1
        self._spp = samples.end
        return opened

    def take_lease(
        self, fence: int, threads: int, workers: int, target_s: float, tiles_out: Path
    ) -> RenderLease | None:
        """Lease tiles of the oldest pass that has some, for about `target_s` seconds on `threads` threads. The paths of
        their files will begin with `tiles_out`."""
        work = next((p for p in self._passes.values() if p.pending), None)
        if work is None or self.facts is None or self._grid is None:
            return None
        count = self._lease_size(work, threads, workers, target_s)
        tiles = tuple(work.pending.popleft() for _ in range(count))
        work.leased.update(tiles)
        lease = RenderLease(
            fence=fence,
            job_id=self.id,
            scene=self.scene,
            seed=self.request.seed,
            pass_index=work.index,
            samples=work.samples,
            tiles=tiles,
            rects=tuple(self._grid.rect(tile) for tile in tiles),
            tiles_out=tiles_out,
        )
        self._leases[fence] = lease
        return lease

    def note_samples(self, lease: RenderLease, samples: int) -> None:
        """The engine says how many camera samples of the lease it has finished."""
        if lease.fence in self._leases:
            self._in_flight[lease.fence] = samples

    def note_cost(self, lease: RenderLease, position: int, seconds: float) -> None:
        """A tile took `seconds` on one thread."""
        cost = seconds / max(1, lease.rects[position].area * lease.samples.count)
        self._cost_s = cost if self._cost_s is None else (1 - COST_WEIGHT) * self._cost_s + COST_WEIGHT * cost

    def commit(self, fence: int, pass_index: int, tile: int, sha256: str) -> None:
        """The ledger took a tile."""
        work = self._passes.get(pass_index)
        if fence not in self._leases or work is None or tile in work.done:
            return
        assert self._grid is not None
        work.leased.discard(tile)
        work.done[tile] = sha256
        self._samples += self._grid.rect(tile).area * work.samples.count

    def end_lease(self, fence: int) -> list[Path]:
        """The lease is over; its tiles that are not done become pending again, in front. Returns their files."""
        if fence == self.single_lease:
            self.single_lease = None
        lease = self._leases.pop(fence, None)
        self._in_flight.pop(fence, None)
        work = None if lease is None else self._passes.get(lease.pass_index)
        if lease is None or work is None:
            return []
        undone = [position for position, tile in enumerate(lease.tiles) if tile in work.leased]
        tiles = [lease.tiles[position] for position in undone]
        work.leased.difference_update(tiles)
        work.pending.extendleft(reversed(tiles))
        return [lease.file(position) for position in undone]

    def end_merge(self, seconds: float, now: float) -> None:
        """An engine process has merged for `seconds`; the revision is still to be stored."""
        self._next_merge = now + MERGE_PAUSE * seconds

    def publish(self, revision: Revision) -> None:
        """A revision contains all passes before `revision.passes`."""
        self.single_lease = None
        for index in sorted(index for index in self._passes if index < revision.passes):
            merged = self._passes.pop(index)
            self._loose_passes += 1
            self.loose_tiles += merged.tiles()
        if revision.film is not None:
            self.film, self.loose_tiles, self._loose_passes = revision.film, (), 0
        self._merged_passes = revision.passes
        self._newest = revision
        if revision.error_bound is not None:
            self._begin_round(revision)

    # ---- questions ----

    def running_s(self, now: float) -> float:
        """Seconds spent in RUNNING so far, over all restarts and pauses."""
        return self._running_before + (0.0 if self._running_since is None else now - self._running_since)

    def mergeable(self, now: float) -> list[PassRun]:
        """Complete passes that come next in the film, oldest first; none while the newest revision is fresh, unless the
        job waits for them."""
        ready: list[PassRun] = []
        waited_for = self._is_last_merge or has_barriers(self._goal, self.request.limits)
        waited_for = waited_for or (self._is_decision_due and self.all_passes_complete)
        if not waited_for and now < self._next_merge:
            return ready
        while (work := self._passes.get(self._merged_passes + len(ready))) is not None and work.complete:
            ready.append(work)
        return ready

    def decision(self, ready: list[PassRun]) -> Decision | None:
        """What the engine has to decide after merging `ready`, if that ends a round towards an error goal."""
        if not self._is_decision_due or len(ready) < len(self._passes):
            return None
        assert self._goal.rel_error is not None and self._round is not None
        most = ceiling_spp(self._goal, self.request.limits) or UNBOUNDED_SPP
        return Decision(self._goal.rel_error, self._round.number, most, self.scene)

    def wants_film(self, ready: list[PassRun]) -> bool:
        """Whether the merge of `ready` should write a film."""
        return self._is_last_merge or self._loose_passes + len(ready) >= PASSES_TO_A_FILM

    def has_lease(self, fence: int) -> bool:
        """Whether a lease of this run is still open; those of a run before a pause are not."""
        return fence in self._leases or fence == self.single_lease

    @property
    def newest(self) -> Revision | None:
        """The newest revision."""
        return self._newest

    @property
    def stop(self) -> Stop | None:
        """Set once no further pass will be opened."""
        return self._stop

    @property
    def all_passes_complete(self) -> bool:
        """Whether no tile is left to render in any open pass."""
        return all(work.complete for work in self._passes.values())

    @property
    def all_merged(self) -> bool:
        """Whether the newest revision contains everything."""
        return not self._passes and self.single_lease is None

    @property
    def grid(self) -> TileGrid | None:
        """The tiles, once the scene is known."""
        return self._grid

    def samples_in_flight(self) -> int:
        """Camera samples that engine processes report beyond the committed tiles."""
        extra = 0
        for fence, samples in self._in_flight.items():
            lease = self._leases[fence]
            work = self._passes.get(lease.pass_index)
            committed = (
                0
                if work is None
                else sum(rect.area for tile, rect in zip(lease.tiles, lease.rects, strict=True) if tile in work.done)
            )
            extra += max(0, samples - committed * lease.samples.count)
        return extra

    def tiles_left(self) -> int:
        """Tiles of the opened passes that are not committed."""
        return sum(len(work.pending) + len(work.leased) for work in self._passes.values())

    @property
    def _is_decision_due(self) -> bool:
        """Whether all passes of a round towards an error goal are opened, and none of the next one."""
        return self._goal.rel_error is not None and self._round is not None and self._spp >= self._round.samples.end

    @property
    def _is_last_merge(self) -> bool:
        return self._stop is not None and self.all_passes_complete

    def _begin_round(self, decision: Revision) -> None:
        """An error goal was decided."""
        self._round = decision.next_round
        self.samples_expected = decision.samples_expected
        if self._round is not None:
            self._spp = self._round.samples.begin

    def _add_pass(self, opened: OpenedPass) -> PassRun:
        assert self._grid is not None
        among = None if opened.tiles is None else frozenset(opened.tiles)
        tiles = (tile for tile in self._grid.order() if among is None or tile in among)
        work = self._passes[opened.index] = PassRun(opened.index, opened.samples, deque(tiles))
        return work

    def _sample_s(self, now: float) -> float:
        """Seconds that one more sample of every pixel of the round takes, by the rate so far; 0 while unknown."""
        assert self._grid is not None
        if self._samples == 0 or self._round is None:
            return 0.0
        if self._round.tiles is None:
            pixels = self._grid.crop.area
        else:
            pixels = sum(self._grid.rect(tile).area for tile in self._round.tiles)
        return self.running_s(now) * pixels / self._samples

    def _lease_size(self, work: PassRun, threads: int, workers: int, target_s: float) -> int:
        """Number of tiles for one lease; small while the cost of a tile is unknown."""
        assert self._grid is not None
        if self._cost_s is None:
            wanted = 4 * threads
        else:
            tile_s = self._cost_s * self._grid.tile_size**2 * work.samples.count
            wanted = int(target_s * threads / max(tile_s, 1e-9))
        fair = -(-len(work.pending) // workers)
        return max(1, min(max(wanted, threads), fair, MOST_TILES_IN_A_LEASE, len(work.pending)))
