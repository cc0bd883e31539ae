"""Writes tests/render/references/NAME.json: block means of an outside scene by Mitsuba 3, with their standard errors.

Needs a Python with mitsuba and numpy (a peer for references only, no dependency of Fluxfarm), and takes up to an hour:

    PEER_PYTHON tests/render/make_reference.py cornell-box --size 256x256 --spp 256 --runs 24
    PEER_PYTHON tests/render/make_reference.py veach-mis --size 256x144 --spp 512 --runs 32
    PEER_PYTHON tests/render/make_reference.py veach-bidir --size 256x256 --spp 1024 --runs 40

Equal depth: the scenes' own max_depth. The film samples beyond its border (sample_border), as pixel filters do here.

Mitsuba's sphere lights take 1 - cos(theta) of the cone that the sphere fills as a difference of float32 numbers. For
the smallest lamp of veach-mis that is wrong by up to 0.2 %, in steps, with the distance (a plane lit by it alone:
0.1225 %, -0.0557 %, 0.1733 % at 6.8, 8.9, 10.2 units, as predicted to four digits). Here it is a mesh of equal area.
"""

import argparse
import json
import re
import tempfile
from pathlib import Path

import numpy as np

BLOCK = 16


def block_means(images: np.ndarray) -> np.ndarray:
    """(runs, height, width, 3) pixels to (runs, rows, columns, 3) means of BLOCK x BLOCK pixels."""
    runs, height, width, channels = images.shape
    return images.reshape(runs, height // BLOCK, BLOCK, width // BLOCK, BLOCK, channels).mean((2, 4))


def summary(images: np.ndarray) -> dict[str, list]:
    """Means and medians over the runs of each block, each with its standard error."""
    blocks = block_means(images.astype(np.float64))
    runs = len(blocks)
    medians = np.median(blocks, 0)
    # Standard deviation from the median absolute deviation; the median's error is sqrt(pi/2) times that of the mean.
    robust_sd = 1.4826 * np.median(np.abs(blocks - medians), 0)
    tables = {
        "means": blocks.mean(0),
        "mean_errors": blocks.std(0, ddof=1) / np.sqrt(runs),
        "medians": medians,
        "median_errors": np.sqrt(np.pi / 2) * robust_sd / np.sqrt(runs),
    }
    return {name: [[[float(f"{v:.6g}") for v in c] for c in row] for row in table] for name, table in tables.items()}


def icosphere(subdivisions: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3) and faces (m, 3) of a subdivided icosahedron with the area of the unit sphere."""
    golden = (1 + 5**0.5) / 2
    pairs = [(a, b * golden) for a in (-1, 1) for b in (-1, 1)]
    vertices = np.array([np.roll((0, a, b), shift) for shift in range(3) for a, b in pairs])
    distances = np.linalg.norm(vertices[:, None] - vertices[None], axis=2)
    near = np.isclose(distances, 2)
    corners = [
        (i, j, k) for i in range(12) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[i, k]
    ]
    triangles = vertices[np.array(corners)]
    inward = (
        np.einsum(
            "ti,ti->t", np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), triangles[:, 0]
        )
        < 0
    )
    triangles[inward] = triangles[inward][:, ::-1]
    for _ in range(subdivisions):
        a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
        ab, bc, ca = a + b, b + c, c + a
        triangles = np.concatenate([np.stack(t, 1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
        triangles /= np.linalg.norm(triangles, axis=2, keepdims=True)
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    triangles *= np.sqrt(4 * np.pi / (np.linalg.norm(cross, axis=1).sum() / 2))
    return triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)


def small_spheres_to_meshes(xml: str, folder: Path) -> str:
    """The scene with each sphere of a radius below 0.1 as a PLY mesh in `folder`."""
    vertices, faces = icosphere(5)

    def to_mesh(match: re.Match[str]) -> str:
        radius = float(match["radius"])
        if radius >= 0.1:
            return match[0]
        points = radius * vertices + [float(match[axis]) for axis in "xyz"]
        path = folder / f"sphere-{match.start()}.ply"
        head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n"
        head += "property float x\nproperty float y\nproperty float z\n"
        head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
        lines = [f"{x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in points] + [f"3 {i} {j} {k}\n" for i, j, k in faces]
        path.write_text(head + "".join(lines))
        return f'<shape type="ply"><string name="filename" value="{path}"/><boolean name="face_normals" value="true"/>'

    sphere = (
        r'<shape type="sphere"[^>]*>\s*<float name="radius" value="(?P<radius>[^"]+)" />\s*'
        r'<point name="center" x="(?P<x>[^"]+)" y="(?P<y>[^"]+)" z="(?P<z>[^"]+)" />'
    )
    return re.sub(sphere, to_mesh, xml)


def render_runs(scene: Path, width: int, height: int, spp: int, runs: int) -> np.ndarray:
    """(runs, height, width, 3) float32, each run with its own seed."""
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    xml = scene.read_text().replace("models/", f"{scene.parent.resolve()}/models/")
    border = '<boolean name="sample_border" value="true"/></film>'
    xml = xml.replace("</film>", border)
    with tempfile.TemporaryDirectory() as folder:
        loaded = mi.load_string(small_spheres_to_meshes(xml, Path(folder)), resx=width, resy=height, spp=spp)
    images = [np.array(mi.render(loaded, spp=spp, seed=1000 + run))[..., :3] for run in range(runs)]
    return np.stack(images)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", help="folder of the scene in the shared collection")
    parser.add_argument("--size", default="256x256")
    parser.add_argument("--spp", type=int, default=256, help="samples per pixel and run")
    parser.add_argument("--runs", type=int, default=24)
    options = parser.parse_args()
    here = Path(__file__).parent
    scene = here.parents[2] / "shared" / "scenes-data" / options.name / "scene.xml"
    width, height = map(int, options.size.split("x"))
    images = render_runs(scene, width, height, options.spp, options.runs)
    write_reference(here / "references" / f"{options.name}.json", images, options.spp)


def write_reference(path: Path, images: np.ndarray, spp: int) -> None:
    """The JSON file of one scene."""
    import mitsuba as mi

    runs, height, width, _ = images.shape
    head = {
        "renderer": f"Mitsuba {mi.__version__} path, llvm_ad_rgb, independent sampler",
        "width": width,
        "height": height,
        "block": BLOCK,
        "spp_per_run": spp,
        "runs": runs,
        "image_mean": [float(f"{v:.6g}") for v in images.astype(np.float64).mean((0, 1, 2))],
    }
    path.parent.mkdir(exist_ok=True)
    path.write_text(json.dumps({**head, **summary(images)}, separators=(",", ":")) + "\n")


if __name__ == "__main__":
    main()
