"""Writes tests/render/references/NAME.json: block means of an outside scene by Mitsuba 3, with their standard errors.

Needs a Python with mitsuba and numpy (a peer for references only, no dependency of Fluxfarm), and takes up to an hour:

    PEER_PYTHON tests/render/make_reference.py cornell-box --size 256x256 --spp 256 --runs 24
    PEER_PYTHON tests/render/make_reference.py veach-mis --size 256x144 --spp 512 --runs 32
    PEER_PYTHON tests/render/make_reference.py veach-bidir --size 256x256 --spp 1024 --runs 40

Equal depth: the scenes' own max_depth. The film samples beyond its border (sample_border), as pixel filters do here.
"""

import argparse
import json
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


def render_runs(scene: Path, width: int, height: int, spp: int, runs: int) -> np.ndarray:
    """(runs, height, width, 3) float32, each run with its own seed."""
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    xml = scene.read_text().replace("models/", f"{scene.parent.resolve()}/models/")
    border = '<boolean name="sample_border" value="true"/></film>'
    xml = xml.replace("</film>", border)
    loaded = mi.load_string(xml, resx=width, resy=height, spp=spp)
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
