"""SVG to PNG. Text needs a font of the machine; the library leaves it out without a word where it finds none."""

import resvg_py

from fluxfarm.errors import ChartError

FAMILIES = ("DejaVu Sans", "Liberation Sans", "Noto Sans", "Arial", "Helvetica")
PROBE = '<svg xmlns="http://www.w3.org/2000/svg" width="20" height="20">{}</svg>'


def png_of(svg: str) -> bytes:
    """The picture at its own size; raises ChartError where no font can be found."""
    return resvg_py.svg_to_bytes(svg_string=svg, sans_serif_family=_family())


def _family() -> str:
    """The first family that draws something."""
    empty = resvg_py.svg_to_bytes(svg_string=PROBE.format(""))
    text = PROBE.format('<text x="2" y="15" font-family="sans-serif">0</text>')
    for family in FAMILIES:
        if resvg_py.svg_to_bytes(svg_string=text, sans_serif_family=family) != empty:
            return family
    raise ChartError(f"a PNG needs a font: none of {', '.join(FAMILIES)} is there; install fonts-dejavu-core")
