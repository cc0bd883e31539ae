"""A real service with the real engine, as a process that can be killed and started again."""

from pathlib import Path

from conftest import ENGINE, ROOT, Layers, read_exr
from farm_client import Client, ServiceProcess

from fluxfarm.settings import Settings

SCENE = ROOT / "scenes" / "cornell-glass" / "scene.xml"
SPP = 100
SIDE = 96
SEED = 7


class Farm:
    """A service process that can be killed and started again on the same data."""

    def __init__(self, folder: Path, tile_size: int = 16, workers: int = 1) -> None:
        self.folder = folder
        self.workers = workers
        self.settings = Settings(data=folder / "data", port=0, engine=str(ENGINE), tile_size=tile_size, threads=1)
        self.start()

    def start(self) -> None:
        self.service = ServiceProcess(self.settings, self.workers)

    @property
    def client(self) -> Client:
        assert self.service.client is not None
        return self.service.client

    def submit(self, scene: Path = SCENE, goal: dict[str, float] | None = None, integrator: str | None = None) -> str:
        size = {"width": SIDE, "height": SIDE}
        wanted = {"size": size, "goal": goal or {"spp": SPP}, "seed": SEED, "integrator": integrator}
        return self.client.submit(scene.read_text(), **wanted)

    def tiles_done(self, job_id: str) -> int:
        return int(self.client.job(job_id)["progress"]["tiles_done"])

    def wait_for_tiles(self, job_id: str, count: int) -> None:
        self.client.wait_until(job_id, lambda job: job["progress"]["tiles_done"] >= count)

    def layers(self, job_id: str) -> Layers:
        self.client.succeed(job_id)
        image = self.folder / "image.exr"
        image.write_bytes(self.client.http.get(f"/v1/jobs/{job_id}/image.exr").content)
        return read_exr(image)

    def engine_pids(self) -> list[int]:
        return [worker["pid"] for worker in self.client.http.get("/v1/workers").json()["workers"] if worker["pid"]]
