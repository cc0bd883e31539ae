"""A hall with many lamps: their number cuts the same lit area and the same power into more pieces. Never committed."""

from pathlib import Path

import numpy as np
from scene_head import scene_head

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
