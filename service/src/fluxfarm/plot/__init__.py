"""Curves as an SVG, on logarithmic axes."""

from fluxfarm.plot.curves import Band, Curve, Panel, Point
from fluxfarm.plot.drawing import draw

__all__ = ["Band", "Curve", "Panel", "Point", "draw"]
