"""How far a picture is from the reference: relMSE, and FLIP for the eye.

[Andersson21] P. Andersson et al., "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics 2021 short
papers: HDR-FLIP, here by its authors' library with its defaults (67 pixels a degree, exposures from the reference).
"""

from dataclasses import dataclass

import flip_evaluator
import numpy as np
import numpy.typing as npt

from fluxfarm.chart.images import Image
from fluxfarm.errors import ChartError


@dataclass(frozen=True, slots=True)
class Flip:
    """The mean over the picture, 0 (alike) to 1, and each pixel's value in the colours of magma, (height, width, 3)."""

    mean: float
    picture: npt.NDArray[np.uint8]


def rel_mse(image: Image, reference: Image) -> float:
    """Mean over pixels and channels of (I - R)^2 / (R^2 + 1e-2)."""
    return float(np.mean(squared_errors(image, reference)))


def squared_errors(image: Image, reference: Image) -> Image:
    """(height, width, 3) of (I - R)^2 / (R^2 + 1e-2)."""
    return (image - reference) ** 2 / (reference**2 + 1e-2)


def flip(image: Image, reference: Image) -> Flip:
    """HDR-FLIP between two pictures of linear radiance. Radiance below 0 counts as 0; both are divided by the
    reference's mean, which must be above 0: the library takes very dark pictures for black and ends the process."""
    mean_radiance = float(reference.mean())
    if not mean_radiance > 0:
        raise ChartError(f"the reference's mean radiance is {mean_radiance}, expected more than 0")
    picture, mean, _ = flip_evaluator.evaluate(
        *(np.ascontiguousarray(np.maximum(part, 0) / mean_radiance, np.float32) for part in (reference, image)), "HDR"
    )
    return Flip(float(mean), np.rint(255 * np.clip(picture, 0, 1)).astype(np.uint8))
