"""Speed with its error: path tracing against bare Embree on its own rays, against Mitsuba 3 at equal error, and with a
thousand emitters against ten.

    .venv/bin/python tests/benchmarks/bench.py --out out/bench.json

Mitsuba is measured where the variable PEER_PYTHON names a Python that has it; else that part is left out, and said so.
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

sys.path.insert(0, str(Path(__file__).parent))
import many_lights
import million

ROOT = Path(__file__).parents[2]
ENGINE = Path(sys.executable).with_name("fluxfarm-engine")
SCENES_DATA = Path(os.environ.get("FLUXFARM_SCENES_DATA", ROOT.parent / "shared" / "scenes-data"))
SIDE = 256
THREADS = "2"
# A thousand emitters may cost so many times the time to equal error of ten.
MOST_FOR_A_THOUSAND = 2.0
LIGHTS_SPP = 64


def scenes(out: Path) -> dict[str, Path]:
    """The scenes there are, by name."""
    found = {"million": million.write(out.parent / "million")}
    for name in ("cornell-box", "veach-bidir"):
        scene = SCENES_DATA / name / "scene.xml"
        if scene.exists():
            found[name] = scene
        else:
            print(f"left out: {scene} does not exist (set FLUXFARM_SCENES_DATA)")
    return found


def ray_rates(scene: Path) -> dict[str, Any]:
    command = [ENGINE, "bench", "path", scene, "--threads", THREADS, "--size", f"{SIDE}x{SIDE}", "--json"]
    return dict(json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout))


def render(scene: Path, out: Path, spp: int, seed: int) -> tuple[np.ndarray, float]:
    """(height, width, 3) float64 and the seconds of rendering alone."""
    image, report = out.parent / "bench.exr", out.parent / "bench-report.json"
    options = ["--size", f"{SIDE}x{SIDE}", "--spp", str(spp), "--seed", str(seed), "--threads", THREADS]
    subprocess.run([ENGINE, "render", scene, "-o", image, "--report", report, *options], check=True)
    with OpenEXR.File(str(image), separate_channels=True) as file:
        pixels = np.stack([file.channels()[c].pixels for c in "RGB"], axis=-1).astype(np.float64)
    return pixels, float(json.loads(report.read_text())["seconds"]["render"])


def rel_mse(image: np.ndarray, reference: np.ndarray) -> float:
    """Mean over pixels and channels of (I - R)^2 / (R^2 + 1e-2)."""
    return float(np.mean((image - reference) ** 2 / (reference**2 + 1e-2)))


def against_mitsuba(name: str, scene: Path, out: Path, peer: str, spp: int) -> dict[str, Any]:
    """Both renderers at equal spp, three seeds each, against a reference of 32 times as many samples of our own."""
    reference, _ = render(scene, out, 32 * spp, 999)
    ours = [
        (rel_mse(image, reference), seconds) for image, seconds in (render(scene, out, spp, seed) for seed in range(3))
    ]
    images = out.parent / f"mitsuba-{name}.npz"
    script = Path(__file__).with_name("mitsuba_peer.py")
    subprocess.run([peer, script, scene, str(SIDE), str(spp), images], check=True)
    result: dict[str, Any] = {"spp": spp, "ours": summary(ours, spp)}
    with np.load(images) as data:
        for sampler in ("independent", "multijitter"):
            runs = zip(data[f"{sampler}_images"], data[f"{sampler}_seconds"], strict=True)
            result[sampler] = summary([(rel_mse(image, reference), float(s)) for image, s in runs], spp)
    best = min(result[s]["seconds_times_error"] for s in ("independent", "multijitter"))
    result["our_time_to_equal_error_over_mitsubas"] = result["ours"]["seconds_times_error"] / best
    return result


def thousand_emitters(out: Path) -> dict[str, Any]:
    """The same hall lit by ten lamps and by a thousand: time to equal error of the second over that of the first."""
    result: dict[str, Any] = {"spp": LIGHTS_SPP}
    for count in (10, 1000):
        scene = many_lights.write(out.parent / f"lights-{count}", count)
        # Its own error adds an eighth to each of the two.
        reference, _ = render(scene, out, 8 * LIGHTS_SPP, 999)
        images = [render(scene, out, LIGHTS_SPP, seed) for seed in range(3)]
        result[str(count)] = summary([(rel_mse(image, reference), seconds) for image, seconds in images], LIGHTS_SPP)
    ratio = result["1000"]["seconds_times_error"] / result["10"]["seconds_times_error"]
    return {**result, "time_to_equal_error_ratio": ratio, "met": ratio <= MOST_FOR_A_THOUSAND}


def summary(runs: list[tuple[float, float]], spp: int) -> dict[str, float]:
    error, seconds = float(np.median([e for e, _ in runs])), float(np.median([s for _, s in runs]))
    # Error falls as 1 / spp or faster, so the time to a given error is in proportion to the product.
    return {
        "rel_mse": error,
        "seconds": seconds,
        "samples_per_second": SIDE * SIDE * spp / seconds,
        "seconds_times_error": error * seconds,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "bench.json")
    parser.add_argument("--spp", type=int, default=128)
    options = parser.parse_args()
    options.out.parent.mkdir(parents=True, exist_ok=True)
    found = scenes(options.out.resolve())
    results: dict[str, Any] = {}
    peer = os.environ.get("PEER_PYTHON")
    if peer is None:
        print("left out: Mitsuba, as PEER_PYTHON names no Python that has it")
    for name, scene in found.items():
        results[name] = {"rays": ray_rates(scene)}
        rates = results[name]["rays"]
        print(
            f"{name}: path {rates['path_rays_per_second'] / 1e6:.2f} M rays/s, bare Embree "
            f"{rates['embree_rays_per_second'] / 1e6:.2f} M rays/s, ratio {rates['ratio']:.3f}, "
            f"{rates['path_samples_per_second'] / 1e6:.2f} M samples/s"
        )
        if peer is not None:
            results[name]["peer"] = against_mitsuba(name, scene, options.out.resolve(), peer, options.spp)
            for renderer in ("ours", "independent", "multijitter"):
                row = results[name]["peer"][renderer]
                print(f"  {renderer}: {row['samples_per_second'] / 1e6:.2f} M samples/s, relMSE {row['rel_mse']:.3g}")
            ratio = results[name]["peer"]["our_time_to_equal_error_over_mitsubas"]
            print(f"  time to equal relMSE over Mitsuba's best sampler: {ratio:.2f}")
    lights = results["many-lights"] = thousand_emitters(options.out.resolve())
    for count in ("10", "1000"):
        row = lights[count]
        print(f"{count} emitters: relMSE {row['rel_mse']:.3g} in {row['seconds']:.2f} s at {LIGHTS_SPP} spp")
    print(
        f"time to equal error, a thousand emitters over ten: {lights['time_to_equal_error_ratio']:.2f}, "
        f"goal at most {MOST_FOR_A_THOUSAND:g}: {'met' if lights['met'] else 'missed'}"
    )
    options.out.write_text(json.dumps(results, indent=2) + "\n")
    print(options.out)


if __name__ == "__main__":
    main()
