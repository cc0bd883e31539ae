"""A hall with many lamps: their number cuts the same lit area and the same power into more pieces. Never committed."""

from pathlib import Path
from typing import Any

import numpy as np
from peers import Render, rel_mse
from scene_head import scene_head

# A thousand emitters may cost so many times the time to equal error of ten.
MOST_FOR_A_THOUSAND = 2.0
SPP = 64
INTEGRATOR = '<integrator type="path"><boolean name="hide_emitters" value="true"/></integrator>'
HALL = """  <bsdf type="twosided" id="grey">
    <bsdf type="diffuse"><rgb name="reflectance" value="0.5, 0.5, 0.5"/></bsdf>
  </bsdf>
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
    parts = [scene_head(INTEGRATOR, 60, "0, 4, -9", "0, 1, 2"), HALL]
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


def compare(folder: Path, render: Render) -> dict[str, Any]:
    """The same hall lit by ten lamps and by a thousand: time to equal error of the second over that of the first."""
    result: dict[str, Any] = {"spp": SPP}
    for count in (10, 1000):
        scene = write(folder / f"lights-{count}", count)
        # Its own error adds an eighth to each of the two.
        reference, _ = render(scene, 8 * SPP, 999)
        runs = [render(scene, SPP, seed) for seed in range(3)]
        error = float(np.median([rel_mse(image, reference) for image, _ in runs]))
        seconds = float(np.median([seconds for _, seconds in runs]))
        # Error falls as 1 / spp or faster, so the time to a given error is in proportion to the product.
        result[str(count)] = {"rel_mse": error, "seconds": seconds, "seconds_times_error": error * seconds}
        print(f"{count} emitters: relMSE {error:.3g} in {seconds:.2f} s at {SPP} spp")
    ratio = result["1000"]["seconds_times_error"] / result["10"]["seconds_times_error"]
    met = ratio <= MOST_FOR_A_THOUSAND
    print(
        f"time to equal error, a thousand emitters over ten: {ratio:.2f}, "
        f"goal at most {MOST_FOR_A_THOUSAND:g}: {'met' if met else 'missed'}"
    )
    return {**result, "time_to_equal_error_ratio": ratio, "met": met}
