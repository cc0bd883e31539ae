"""Runs a peer's script in the Python that has it.

A script takes a scene, the size, the depth and numbers of samples a pixel, and renders a picture for each number, with
seeds 0, 1, ...; it writes an .npz of `names` (its variants), `images` (variants, numbers, height, width, 3) and
`seconds` of rendering alone (variants, numbers).
"""

import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

LAST_WORDS = 2000


class PeerFailed(Exception):
    """The peer could not render; the text is the end of what it wrote to its standard error."""


@dataclass(frozen=True, slots=True)
class PeerRuns:
    """What one variant of a peer rendered: `images` (numbers, height, width, 3) float64, and the seconds of each."""

    name: str
    images: np.ndarray
    seconds: np.ndarray


def reads_scene(peer: str) -> bool:
    """Whether the peer reads our scene file itself; else it is given what `flat_scene.write` makes of it."""
    return peer == "mitsuba"


def run_peer(
    peer: str,
    python: str,
    scene: Path,
    size: tuple[int, int],
    depth: int,
    counts: Sequence[float],
    out: Path,
    *more: object,
) -> list[PeerRuns]:
    """Each variant's runs; raises PeerFailed. `scene` is the scene or its flat form, `out` a file to write between."""
    script = Path(__file__).with_name(f"{peer}_peer.py")
    numbers = ",".join(map(str, counts))
    command = (python, script, scene, f"{size[0]}x{size[1]}", depth, numbers, out, *more)
    try:
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    except OSError as error:
        raise PeerFailed(f"{python}: cannot be run: {error.strerror}") from None
    if done.returncode != 0:
        raise PeerFailed(done.stderr.strip()[-LAST_WORDS:] or f"{script.name}: status {done.returncode}")
    with np.load(out) as data:
        rows = zip(data["names"].tolist(), data["images"], data["seconds"], strict=True)
        return [PeerRuns(name, images.astype(np.float64), seconds) for name, images, seconds in rows]
