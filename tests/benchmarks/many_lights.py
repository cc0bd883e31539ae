"""A thousand emitters against ten: the same hall, the same lit area and the same power, cut into more pieces.

    .venv/bin/python tests/benchmarks/many_lights.py --out out/many-lights.json

Time to equal error is seconds times relMSE at equal samples: error falls as 1 / samples.
The goal is that a thousand cost at most twice the time of ten.
"""

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from bench import ROOT, render
from peers import SIDE, rel_mse

HALL = """<scene version="3.0.0">
  <integrator type="path"><boolean name="hide_emitters" value="true"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="60"/>
    <transform name="to_world"><lookat origin="0, 4, -9" target="0, 1, 2" up="0, 1, 0"/></transform>
    <film type="hdrfilm">
      <integer name="width" value="256"/>
      <integer name="height" value="256"/>
      <rfilter type="box"/>
    </film>
  </sensor>
  <bsdf type="twosided" id="grey"><bsdf type="diffuse"><rgb name="reflectance" value="0.5, 0.5, 0.5"/></bsdf></bsdf>
  <shape type="rectangle">
    <transform name="to_world"><rotate x="1" angle="-90"/><scale value="10"/></transform><ref id="grey"/>
  </shape>
  <shape type="rectangle">
    <transform name="to_world"><scale value="10"/><translate z="10"/></transform><ref id="grey"/>
  </shape>
"""
LAMP = """  <shape type="{shape}">
    <transform name="to_world">{turn}<scale value="{size}"/><translate x="{x}" y="{y}" z="{z}"/></transform>
    <emitter type="area"><rgb name="radiance" value="{r}, {g}, {b}"/></emitter>
  </shape>
"""
PILLAR = """  <shape type="cube">
    <transform name="to_world"><scale x="0.3" y="2" z="0.3"/><translate x="{x}" y="2" z="{z}"/></transform>
    <ref id="grey"/>
  </shape>
"""


def write(folder: Path, count: int) -> Path:
    """Write a hall with `count` lamps of many colours, strengths and directions; the path of the scene."""
    generator = np.random.default_rng(11)
    parts = [HALL]
    parts += [PILLAR.format(x=x, z=z) for x in (-6, -3, 0, 3, 6) for z in (-2, 2, 6)]
    side = np.sqrt(1.0 / count) / 2  # all together 1 m^2; a lamp's half side
    strengths = generator.lognormal(0, 0.7, count)
    strengths *= count / strengths.sum()
    for i in range(count):
        # Evenly over the floor (R2 sequence), so that ten are spread as a thousand are.
        x, z = (((i + 0.5) * step) % 1 * 18 - 9 for step in (0.7548776662, 0.5698402910))
        r, g, b = 40 * strengths[i] * generator.uniform(0.5, 1.5, 3)
        turn = f'<rotate x="1" angle="90"/><rotate x="1" z="0.3" angle="{generator.uniform(-30, 30):.3f}"/>'
        parts.append(LAMP.format(shape="rectangle", turn=turn, size=side, x=x, y=4.2, z=z, r=r, g=g, b=b))
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / "scene.xml"
    scene.write_text("".join(parts) + "</scene>\n")
    return scene


def summary(runs: list[tuple[float, float]], spp: int) -> dict[str, float]:
    error, seconds = float(np.median([e for e, _ in runs])), float(np.median([s for _, s in runs]))
    # Error falls as 1 / spp or faster, so the time to a given error is in proportion to the product.
    return {
        "rel_mse": error,
        "seconds": seconds,
        "samples_per_second": SIDE * SIDE * spp / seconds,
        "seconds_times_error": error * seconds,
    }


def measure(scene: Path, out: Path, spp: int, seeds: int) -> dict[str, float]:
    reference, _ = render(scene, out, 16 * spp, 999)
    runs = []
    for seed in range(seeds):
        image, seconds = render(scene, out, spp, seed)
        runs.append((rel_mse(image, reference), seconds))
    return summary(runs, spp)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "many-lights.json")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--seeds", type=int, default=5)
    options = parser.parse_args()
    out = options.out.resolve()
    out.parent.mkdir(parents=True, exist_ok=True)
    results: dict[str, Any] = {}
    for count in (10, 1000):
        scene = write(out.parent / f"lights-{count}", count)
        results[str(count)] = measure(scene, out, options.spp, options.seeds)
        row = results[str(count)]
        print(f"{count} emitters: relMSE {row['rel_mse']:.3g} in {row['seconds']:.2f} s at {options.spp} spp")
    ratio = results["1000"]["seconds_times_error"] / results["10"]["seconds_times_error"]
    results["time_to_equal_error_1000_over_10"] = ratio
    print(f"time to equal error, a thousand over ten: {ratio:.2f}")
    out.write_text(json.dumps(results, indent=2) + "\n")
    print(out)


if __name__ == "__main__":
    main()
