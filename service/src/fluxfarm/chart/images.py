"""Pictures as arrays: read from OpenEXR, written as PNG for the eye."""

import struct
import zlib
from pathlib import Path

import numpy as np
import numpy.typing as npt
import OpenEXR

from fluxfarm.errors import ChartError

Image = npt.NDArray[np.float64]


def read_channels(path: Path) -> dict[str, npt.NDArray[np.float32]]:
    """(height, width) of each channel by its full name; raises ChartError for what is no such picture."""
    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            channels = {name: channel.pixels for name, channel in file.channels().items()}
    except (RuntimeError, OSError, ValueError) as error:
        raise ChartError(f"{path}: cannot be read as OpenEXR: {error}") from None
    missing = [name for name in "RGB" if name not in channels]
    if missing:
        raise ChartError(f"{path}: has no channel {missing[0]}, expected R, G and B")
    return channels


def read_exr(path: Path) -> Image:
    """(height, width, 3) radiance, linear Rec.709."""
    channels = read_channels(path)
    return np.stack([channels[name] for name in "RGB"], axis=-1).astype(np.float64)


def display(image: Image, white: float) -> npt.NDArray[np.uint8]:
    """sRGB bytes; radiance `white` and all above it are white."""
    linear = np.clip(image / white, 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.asarray(np.rint(255 * encoded), np.uint8)


def write_png(path: Path, pixels: npt.NDArray[np.uint8]) -> None:
    """(height, width, 3) bytes as a PNG: a header, the rows (each after its filter's number, 0) deflated, an end."""
    height, width, _ = pixels.shape
    rows = np.concatenate([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)], axis=1)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    parts = (_chunk(b"IHDR", header), _chunk(b"IDAT", zlib.compress(rows.tobytes(), 9)), _chunk(b"IEND", b""))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(parts))


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
