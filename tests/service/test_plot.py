"""Curves on logarithmic axes."""

import xml.etree.ElementTree as ET

import pytest

from fluxfarm.plot import Curve, Panel, draw
from fluxfarm.plot.scale import LogScale, scale_of

SVG = "{http://www.w3.org/2000/svg}"


def test_scale_places_powers_at_equal_distances() -> None:
    scale = LogScale(0.1, 10, 0, 200)
    assert [scale.place(value) for value in (0.1, 1, 10)] == pytest.approx([0, 100, 200])
    assert scale.ticks() == [0.1, 0.2, 0.5, 1, 2, 5, 10]


def test_scale_ends_at_the_ticks_around_its_values() -> None:
    scale = scale_of([0.3, 7, 4], 0, 1)
    assert (scale.low, scale.high) == (0.2, 10)
    alone = scale_of([1.0], 0, 1)
    assert (alone.low, alone.high) == (1, 2)
    assert scale_of([1e-6, 1.0], 0, 1).ticks() == [10.0**power for power in range(-6, 1)]


def test_every_part_of_a_curve_is_drawn_inside_its_panel() -> None:
    curve = Curve([(1, 0.1), (10, 0.01)], "a < b & c", band=[(1, 0.05, 0.2), (10, 0.005, 0.02)], diamonds=[(2, 0.3)])
    root = ET.fromstring(draw([Panel([curve], "seconds", "error"), Panel([curve], "seconds", "other")], ["a note"]))
    texts = [element.text for element in root.iter(f"{SVG}text")]
    assert texts.count("a < b & c") == 1, "one line in the legend for both panels"
    assert {"a note", "seconds", "error", "other"} <= set(texts)
    assert len(list(root.iter(f"{SVG}polyline"))) == len(list(root.iter(f"{SVG}polygon"))) == 2
    for line in [*root.iter(f"{SVG}polyline"), *root.iter(f"{SVG}polygon")]:
        for pair in line.attrib["points"].split():
            x, y = map(float, pair.split(","))
            assert 56 <= x <= 640 - 56
            assert 56 <= y <= 400 - 56
