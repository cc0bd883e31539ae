"""An authored scene of a million triangles: hills under a sky and a lamp. Written to a folder, never committed."""

from pathlib import Path

import numpy as np
from scene_head import scene_head

SIDE = 708  # quads along each side: 2 x 708^2 = 1,002,528 triangles

INTEGRATOR = """<default name="max_depth" value="-1"/>
  <integrator type="path"><integer name="max_depth" value="$max_depth"/></integrator>"""
HILLS = """  <emitter type="constant"><rgb name="radiance" value="0.4, 0.5, 0.7"/></emitter>
  <shape type="sphere">
    <point name="center" x="2" y="3" z="1"/>
    <float name="radius" value="0.3"/>
    <emitter type="area"><rgb name="radiance" value="60, 50, 35"/></emitter>
  </shape>
  <shape type="ply">
    <string name="filename" value="hills.ply"/>
    <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.5, 0.55, 0.4"/></bsdf></bsdf>
  </shape>
</scene>
"""


def heights(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Sums of waves of falling height and random direction, the same ones every time. (n, n) float64, metres."""
    generator = np.random.default_rng(7)
    total = np.zeros_like(x)
    for octave in range(9):
        angle, phase = generator.uniform(0, 2 * np.pi, 2)
        frequency = 1.3 * 1.9**octave
        total += 0.35 * 0.55**octave * np.sin(frequency * (x * np.cos(angle) + z * np.sin(angle)) + phase)
    return total


def write(folder: Path) -> Path:
    """Write hills.ply (binary, without normals) and scene.xml into `folder`; the path of the scene."""
    folder.mkdir(parents=True, exist_ok=True)
    axis = np.linspace(-3, 3, SIDE + 1)
    x, z = np.meshgrid(axis, axis, indexing="ij")
    vertices = np.stack([x, heights(x, z), z], axis=-1).reshape(-1, 3).astype("<f4")
    corner = (np.arange(SIDE)[:, None] * (SIDE + 1) + np.arange(SIDE)).ravel()
    quads = np.stack([corner, corner + 1, corner + SIDE + 2, corner + SIDE + 1], axis=-1)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    faces = np.empty(len(triangles), dtype=[("count", "u1"), ("indices", "<u4", 3)])
    faces["count"], faces["indices"] = 3, triangles
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar uint vertex_indices\nend_header\n"
    )
    (folder / "hills.ply").write_bytes(header.encode() + vertices.tobytes() + faces.tobytes())
    scene = folder / "scene.xml"
    scene.write_text(scene_head(INTEGRATOR, 40, "0, 2.2, 4.2", "0, 0.2, 0") + HILLS)
    return scene
