"""How much sooner two workers end a job than one, with one thread each: files of the scene, tiles and merging included.

    farm_scaling.py [--scene cornell] [--seconds 60] [--runs 3] [--size 256x256]

A service, a scheduler and the workers run on this machine, over TLS; seconds are those in RUNNING. The samples of the
job are chosen so that one worker takes about `--seconds`. Where the machine has no more cores than workers, all else
has to share these.
"""

import argparse
import statistics
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests" / "service"))

from farm_nodes import Nodes  # noqa: E402

ENGINE = Path(sys.executable).with_name("fluxfarm-engine")


def seconds_of(nodes: Nodes, scene: str, spp: int, size: tuple[int, int], seed: int) -> float:
    assert nodes.client is not None
    width, height = size
    body = {"scene": {"builtin": scene}, "size": {"width": width, "height": height}, "goal": {"spp": spp}, "seed": seed}
    job_id = nodes.client.http.post("/v1/jobs", json=body | {"integrator": "path"}).json()["id"]
    nodes.client.succeed(job_id, timeout_s=1800)
    return float(nodes.client.http.get(f"/v1/jobs/{job_id}/report").json()["seconds"]["RUNNING"])


def measure(workers: int, scene: str, spp: int, size: tuple[int, int], runs: int) -> list[float]:
    with tempfile.TemporaryDirectory(prefix="fluxfarm-") as folder:
        nodes = Nodes(Path(folder), ENGINE)
        try:
            for _ in range(workers):
                nodes.add_worker()
            nodes.serve()
            nodes.wait_for_ready(workers)
            seconds_of(nodes, scene, 1, size, 0)
            return [seconds_of(nodes, scene, spp, size, seed) for seed in range(1, runs + 1)]
        finally:
            nodes.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", default="cornell")
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--size", default="256x256")
    options = parser.parse_args()
    width, height = map(int, options.size.split("x"))
    size = (width, height)
    trial = 32
    spp = max(1, round(trial * options.seconds / measure(1, options.scene, trial, size, 1)[0]))
    times = {workers: measure(workers, options.scene, spp, size, options.runs) for workers in (1, 2)}
    for workers, found in times.items():
        print(f"{workers} worker(s): {statistics.median(found):.2f} s ({', '.join(f'{s:.2f}' for s in found)})")
    ratio = statistics.median(times[1]) / statistics.median(times[2])
    print(f"{options.scene}, {options.size}, {spp} samples a pixel: two are {ratio:.2f} times as fast (goal: 1.85)")


if __name__ == "__main__":
    main()
