"""Writes tests/render/references/NAME.json: block means of an outside scene by Mitsuba 3, with their standard errors.

Needs a Python with mitsuba and numpy (a peer for references only, no dependency of Fluxfarm), and takes up to an hour:

    PEER_PYTHON tests/render/make_reference.py cornell-box --size 256x256 --spp 256 --runs 24
    PEER_PYTHON tests/render/make_reference.py veach-mis --size 256x144 --spp 512 --runs 32
    PEER_PYTHON tests/render/make_reference.py veach-bidir --size 256x256 --spp 1024 --runs 40
    PEER_PYTHON tests/render/make_reference.py veach-ajar --size 128x80 --spp 64 --runs 32
    PEER_PYTHON tests/render/make_reference.py glass-of-milk --size 96x64 --spp 64 --runs 32
    PEER_PYTHON tests/render/make_reference.py gltf-cornell-glass --size 128x128 --spp 64 --runs 20

Equal depth: the scenes' own max_depth. The film samples beyond its border (sample_border), as pixel filters do here.
What is changed in a scene for both renderers: outside_variants.py. For glTF, Mitsuba renders
references/gltf-cornell-glass.xml, the same scene written again by hand.

Mitsuba's sphere lights take 1 - cos(theta) of the cone that the sphere fills as a difference of float32 numbers. For
the smallest lamp of veach-mis that is wrong by up to 0.2 %, in steps, with the distance (a plane lit by it alone:
0.1225 %, -0.0557 %, 0.1733 % at 6.8, 8.9, 10.2 units, as predicted to four digits). Here it is a mesh of equal area.
"""

import argparse
import json
import os
import re
import sys
import tempfile
from pathlib import Path

import numpy as np
import outside_variants
from sphere_meshes import latitude_longitude_sphere

# A module of the package, which the Python that has Mitsuba lacks.
sys.path.insert(0, str(Path(__file__).parents[2] / "service" / "src" / "fluxfarm" / "peers"))
from icosphere import icosphere

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


def mitsuba_xml(name: str, folder: Path, width: int, height: int) -> str:
    """The scene as Mitsuba is given it, with files made for it in `folder`."""
    here = Path(__file__).parent
    if name == "gltf-cornell-glass":
        import gltf_surface  # noqa: F401  registers the plugin

        scene, files = here / "references" / f"{name}.xml", folder
        (folder / "sphere.ply").write_text(latitude_longitude_sphere(96, 48))
    else:
        shared = here.parents[2] / "shared" / "scenes-data"
        scene = Path(os.environ.get("FLUXFARM_SCENES_DATA", shared)) / name / "scene.xml"
        files = scene.parent.resolve()
    xml = outside_variants.as_compared(name, scene.read_text())
    xml = re.sub(r'(name="filename" value=")', rf"\g<1>{files}/", xml)
    xml = small_spheres_to_meshes(xml, folder)
    for side, pixels in (("width", width), ("height", height)):
        xml = re.sub(rf'(<integer name="{side}" value=")[^"]*', rf"\g<1>{pixels}", xml)
    return xml.replace("</film>", '<boolean name="sample_border" value="true"/></film>')


def render_runs(name: str, width: int, height: int, spp: int, runs: int) -> np.ndarray:
    """(runs, height, width, 3) float32, each run with its own seed."""
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    with tempfile.TemporaryDirectory() as folder:
        loaded = mi.load_string(mitsuba_xml(name, Path(folder), width, height))
    images = []
    for run in range(runs):
        images.append(np.array(mi.render(loaded, spp=spp, seed=1000 + run))[..., :3])
        print(f"{name}: run {run + 1} of {runs}", flush=True)
    return np.stack(images)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", help="folder of the scene in the shared collection")
    parser.add_argument("--size", default="256x256")
    parser.add_argument("--spp", type=int, default=256, help="samples per pixel and run")
    parser.add_argument("--runs", type=int, default=24)
    options = parser.parse_args()
    width, height = map(int, options.size.split("x"))
    images = render_runs(options.name, width, height, options.spp, options.runs)
    write_reference(Path(__file__).parent / "references" / f"{options.name}.json", images, options.spp)


def write_reference(path: Path, images: np.ndarray, spp: int) -> None:
    """The JSON file of one scene."""
    import mitsuba as mi

    runs, height, width, _ = images.shape
    head = {
        "renderer": f"Mitsuba {mi.__version__}, llvm_ad_rgb, independent sampler",
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
