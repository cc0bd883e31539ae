"""`fluxfarm chart` without an engine: errors, slopes, the front, what is written, and what is refused."""

import json
import math
import os
import subprocess
import sys
import xml.etree.ElementTree as ET
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fluxfarm.chart.crops import hardest_part, write_crops
from fluxfarm.chart.errors import flip, rel_mse
from fluxfarm.chart.figure import figure
from fluxfarm.chart.images import display, write_png
from fluxfarm.chart.measure import Measured
from fluxfarm.chart.options import METHODS, ChartOptions
from fluxfarm.chart.page import write_page
from fluxfarm.chart.raster import png_of
from fluxfarm.chart.record import as_json
from fluxfarm.chart.reference import Reference, claimed_rel_mse
from fluxfarm.chart.series import Point, Series, pareto_front, slope, summaries
from fluxfarm.errors import ChartError

COMMAND = [sys.executable, "-c", "from fluxfarm.cli import main; main()"]
OPTIONS = ChartOptions(METHODS, {}, 1.0, 2, None, None, 64, Path())
REFERENCE = np.random.default_rng(1).uniform(0.2, 2, (24, 32, 3))


def noisy(error: float, seed: int = 2) -> np.ndarray:
    """The reference with independent noise of that relMSE."""
    spread = error**0.5 * np.sqrt(REFERENCE**2 + 1e-2)
    return REFERENCE + spread * np.random.default_rng(seed).standard_normal(REFERENCE.shape)


# ---- errors ----


def test_rel_mse_of_a_known_pair() -> None:
    reference = np.array([[[0.0, 0.3, 2.0]]])
    image = np.array([[[0.1, 0.0, 2.0]]])
    assert rel_mse(image, reference) == pytest.approx((0.01 / 0.01 + 0.09 / 0.1 + 0) / 3)


def test_flip_is_zero_for_the_same_picture_and_grows_with_noise() -> None:
    means = [flip(noisy(error), REFERENCE).mean for error in (0.0, 1e-3, 1e-1)]
    assert means[0] == 0
    assert 0 < means[1] < means[2] < 1
    assert flip(noisy(0.1), REFERENCE).picture.shape == REFERENCE.shape


@pytest.mark.parametrize("scale", [1e-9, 1e7])
def test_flip_does_not_depend_on_the_unit_of_radiance(scale: float) -> None:
    assert flip(scale * noisy(0.1), scale * REFERENCE).mean == pytest.approx(flip(noisy(0.1), REFERENCE).mean, rel=1e-3)


def test_flip_refuses_a_black_reference() -> None:
    with pytest.raises(ChartError, match="mean radiance is 0"):
        flip(REFERENCE, np.zeros_like(REFERENCE))


def test_claim_adds_the_squares_of_what_is_known() -> None:
    assert claimed_rel_mse({"noise": 0.3, "bias": 0.4, "unseen": None}) == pytest.approx(0.25)
    assert claimed_rel_mse({"noise": None, "bias": 0.4, "unseen": None}) is None


# ---- curves ----


def series(name: str, rows: list[tuple[float, float, float]]) -> Series:
    """A point for each (seconds, samples, relMSE) of one seed, each its own budget."""
    return Series(name, [Point(i, 0, s, spp, error, error / 2, error, 1000) for i, (s, spp, error) in enumerate(rows)])


def test_slope_of_independent_samples_is_minus_one() -> None:
    assert slope([(2.0**i, 3 / 2.0**i) for i in range(5)]) == pytest.approx(-1)


def test_slope_of_an_error_that_stays_is_not_minus_one() -> None:
    stays = slope([(2.0**i, 1 + 1 / 2.0**i) for i in range(5)])
    assert stays is not None
    assert stays > -0.3


def test_slope_needs_two_times_and_errors_above_zero() -> None:
    assert slope([(1.0, 0.1), (1.0, 0.2)]) is None
    assert slope([(1.0, 0.1), (2.0, 0.0)]) is None


def test_runs_that_are_the_same_picture_count_once_in_the_slope() -> None:
    assert series("path", [(1, 1, 0.4), (9, 1, 0.4), (4, 4, 0.1)]).slope("rel_mse") == pytest.approx(-1)
    assert series("path", [(1, 1, 0.4), (2, 1, 0.4)]).slope("rel_mse") is None


def test_pareto_front_by_hand() -> None:
    pairs = [(1, 0.5), (2, 0.6), (2, 0.3), (3, 0.3), (4, 0.1), (0.5, 0.9)]
    assert pareto_front(pairs) == [(0.5, 0.9), (1, 0.5), (2, 0.3), (4, 0.1)]


def test_medians_and_ranges_are_over_the_seeds() -> None:
    points = [Point(0, seed, 1.0 + seed, 1, error, 0.1) for seed, error in enumerate((0.3, 0.1, 0.2))]
    (row,) = summaries(Series("path", points), "rel_mse")
    assert (row.seconds, row.error, row.lowest, row.highest) == (2.0, 0.2, 0.1, 0.3)


def test_budgets_double_up_to_the_longest() -> None:
    assert replace(OPTIONS, seconds=8.0).budgets() == [0.5, 1, 2, 4, 8]


# ---- what is written ----


@pytest.fixture
def measured() -> Measured:
    """Two methods, of which one claims nothing; a third is left out."""
    path = series("path", [(1, 1, 0.4), (2, 2, 0.2), (4, 4, 0.1)])
    silent = Series("photon", [replace(point, claimed_rel_mse=None, rel_mse=0.3) for point in path.points])
    pictures = {"path": {2: noisy(0.1)}, "photon": {2: noisy(0.3)}}
    reference = Reference(REFERENCE, 1e-3, "a long run")
    left_out = {"irradiance-cache": "media & <null> boundaries"}
    return Measured("box", (32, 24), reference, "lens off", 1000.0, [path, silent], pictures, left_out)


def test_record_has_every_point_and_what_follows(measured: Measured) -> None:
    record = json.loads(json.dumps(as_json(measured)))
    path, photon = record["methods"]
    assert [point["rel_mse"] for point in path["points"]] == [0.4, 0.2, 0.1]
    assert [point["seconds"] for point in photon["points"]] == [1, 2, 4]
    assert path["slope"]["rel_mse"] == pytest.approx(-1)
    assert record["pareto"]["rel_mse"] == [[1, 0.3], [2, 0.2], [4, 0.1]]
    assert record["left_out"] == measured.left_out


def test_floor_is_the_error_of_paths_at_the_rate_of_bare_embree(measured: Measured) -> None:
    assert measured.floor() == [(1.0, 0.4), (1.0, 0.2), (1.0, 0.1)], "1000 rays at 1000 rays a second"
    assert replace(measured, embree_rays_per_second=None).floor() == []
    assert replace(measured, series=measured.series[1:]).floor() == []


def test_figure_is_well_formed_and_names_all(measured: Measured) -> None:
    svg = figure(measured)
    text = " ".join(element.text or "" for element in ET.fromstring(svg).iter())
    for words in (
        "path: slope -1.00",
        "photon: slope +0.00",
        "bare Embree",
        "left out: irradiance-cache: media & <null>",
    ):
        assert words in text
    assert png_of(svg).startswith(b"\x89PNG")


def test_figure_of_exact_methods_has_no_axes(measured: Measured) -> None:
    exact = Series(
        "path", [replace(point, rel_mse=0.0, flip=0.0, claimed_rel_mse=0.0) for point in measured.series[0].points]
    )
    ET.fromstring(figure(replace(measured, series=[exact])))


def test_page_leads_to_files_that_are_there(measured: Measured, tmp_path: Path) -> None:
    crops = write_crops(measured, tmp_path / "crops")
    (tmp_path / "box.svg").write_text(figure(measured))
    write_page(tmp_path, "fluxfarm chart a<b", [(measured, crops)])
    page = (tmp_path / "index.html").read_text()
    assert "<script" not in page
    assert "a&lt;b" in page
    targets = [part.split('"')[0] for part in page.split('src="')[1:]]
    assert len(targets) == 1 + 1 + 2 * 2, "the chart, the reference, and two pictures of each method"
    for target in targets:
        assert (tmp_path / target).is_file(), target


def test_hardest_part_is_where_the_errors_are() -> None:
    image = REFERENCE.copy()
    image[2:6, 20:30] += 1
    rows, columns = hardest_part([image], REFERENCE)
    assert (rows.stop - rows.start, columns.stop - columns.start) == (12, 16)
    assert rows.start <= 2
    assert columns.start <= 20
    assert columns.stop >= 30


def test_png_holds_the_bytes_of_srgb(tmp_path: Path) -> None:
    linear = np.array([[[0.0, 0.5, 1.0], [2.0, 0.001, 0.2140411]]])
    write_png(tmp_path / "a.png", display(linear, white=1.0))
    data = (tmp_path / "a.png").read_bytes()
    start = data.index(b"IDAT")
    length = int.from_bytes(data[start - 4 : start])
    assert list(zlib.decompress(data[start + 4 : start + 4 + length])) == [0, 0, 188, 255, 255, 3, 127]
    assert png_of('<svg xmlns="http://www.w3.org/2000/svg" width="2" height="1"/>')[:4] == data[:4]


# ---- bad input ----


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["cornell", "--integrators", "path,magic"], "--integrators: 'magic', expected some of path"),
        (["cornell", "--integrators", ","], "--integrators: none is named"),
        (["cornell", "--peers", "arnold"], "--peers: 'arnold', expected some of mitsuba, cycles, luxcore"),
        (["cornell", "--seconds", "0"], "--seconds = 0.0: expected a number above 0"),
        (["cornell", "--seconds", "-1"], "--seconds = -1.0"),
        (["cornell", "--seconds", "nan"], "--seconds = nan"),
        (["cornell", "--seeds", "0"], "--seeds = 0"),
        (["cornell", "--reference-spp", "0"], "--reference-spp = 0"),
        (["cornell", "--size", "8"], "--size = '8'"),
        (["cornell", "--reference", "no.exr"], "--reference = no.exr: there is no such file"),
        (["cornell", "furnace", "--reference", "no.exr"], "one image, but 2 scenes"),
        (["cornell", "cornell"], "two scenes are called 'cornell'"),
        (["no-such-scene"], "no-such-scene: expected a scene file or a built-in name"),
        (["no/such/scene.xml"], "no/such/scene.xml: there is no such file"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_bad_input_is_one_clear_error(arguments: list[str], words: str, tmp_path: Path) -> None:
    command = [*COMMAND, "chart", *arguments, "-o", str(tmp_path / "out")]
    environment = {**os.environ, "FLUXFARM_ENGINE": sys.executable}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 2, done.stderr
    assert words in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_missing_packages_are_named(tmp_path: Path) -> None:
    """As they are an extra, nothing of them may be imported before they are looked for."""
    code = """import sys
from fluxfarm.cli import charting, main
assert 'numpy' not in sys.modules
charting.PACKAGES['no_such_module'] = 'no-such-package'
main()"""
    command = [sys.executable, "-c", code, "chart", "cornell", "-o", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 3, done.stderr
    assert "needs no-such-package: install the extra fluxfarm[chart]" in done.stderr


def test_numbers_that_are_not_finite_have_no_slope() -> None:
    assert slope([(1.0, math.nan), (2.0, 0.1)]) is None
