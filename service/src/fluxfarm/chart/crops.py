"""Parts of the pictures side by side, at equal time, with maps of their errors."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fluxfarm.chart.errors import flip, squared_errors
from fluxfarm.chart.images import Image, display, write_png
from fluxfarm.chart.measure import Measured

SHARE = 0.5  # of the picture's sides
STRIDE = 4  # pixels between the places that are tried
WHITE_QUANTILE = 0.99  # of the reference's radiance


@dataclass(frozen=True, slots=True)
class Crop:
    """One picture's part and, but for the reference, its map of FLIP; paths of PNG files."""

    name: str
    picture: Path
    errors: Path | None


def write_crops(measured: Measured, folder: Path) -> list[Crop]:
    """The reference's part, then that of each method at the longest budget; first seed."""
    folder.mkdir(parents=True, exist_ok=True)
    reference = measured.reference.image
    last = {name: pictures[max(pictures)] for name, pictures in measured.pictures.items()}
    rows, columns = hardest_part(list(last.values()), reference)
    white = max(float(np.quantile(reference, WHITE_QUANTILE)), 1e-12)

    def write(name: str, image: Image, errors: bool) -> Crop:
        stem = f"{measured.scene}-{name.split(',', maxsplit=1)[0].lower()}"
        picture, error_map = folder / f"{stem}.png", folder / f"{stem}-flip.png"
        write_png(picture, display(image[rows, columns], white))
        if not errors:
            return Crop(name, picture, None)
        write_png(error_map, flip(image, reference).picture[rows, columns])
        return Crop(name, picture, error_map)

    return [write("reference", reference, False), *(write(name, image, True) for name, image in last.items())]


def hardest_part(images: list[Image], reference: Image) -> tuple[slice, slice]:
    """Rows and columns of the part with the largest error, of each pixel the median over the pictures."""
    errors = np.median([squared_errors(image, reference).mean(-1) for image in images], axis=0)
    height, width = errors.shape
    rows, columns = max(1, round(height * SHARE)), max(1, round(width * SHARE))
    places = [
        (top, left) for top in range(0, height - rows + 1, STRIDE) for left in range(0, width - columns + 1, STRIDE)
    ]
    top, left = max(places, key=lambda at: float(errors[at[0] : at[0] + rows, at[1] : at[1] + columns].sum()))
    return slice(top, top + rows), slice(left, left + columns)
