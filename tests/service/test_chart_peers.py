"""Other renderers in a chart, with a program in place of each."""

import stat
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fluxfarm.chart.engine import Refused
from fluxfarm.chart.options import METHODS, ChartOptions
from fluxfarm.chart.others import check_same_picture, measure_peer
from fluxfarm.chart.scenes import LONGEST_PATH, ChartScene, boxed, path_depth
from fluxfarm.peers.running import PeerFailed, run_peer

OPTIONS = ChartOptions(METHODS, {}, 1.0, 2, None, None, 64, Path())
REFERENCE = np.random.default_rng(1).uniform(0.2, 2, (24, 32, 3))
XML = """<scene version="3.0.0"><default name="depth" value="7"/><integrator type="path">
<integer name="max_depth" value="$depth"/></integrator><sensor type="perspective"><sampler type="independent">
<integer name="sample_count" value="4"/></sampler><film type="hdrfilm"><rfilter type="gaussian"/></film></sensor>
</scene>"""


def scene_in(folder: Path, xml: str = XML) -> ChartScene:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.xml").write_text(xml)
    return ChartScene("box", "scene.xml", {"scene.xml": folder / "scene.xml"})


def test_boxed_scene_has_one_box_filter_and_no_sampler(tmp_path: Path) -> None:
    scene = scene_in(tmp_path / "a")
    same = boxed(scene, tmp_path / "b")
    root = ET.parse(same.path).getroot()
    assert [child.get("type") for child in root.iter("rfilter")] == ["box"]
    assert not list(root.iter("sampler"))
    assert path_depth(same) == 7
    assert scene.path.read_text() == XML, "the scene itself stays"
    assert scene.digest() != same.digest()


def test_unbounded_paths_get_a_number_that_peers_can_be_told(tmp_path: Path) -> None:
    assert path_depth(boxed(scene_in(tmp_path / "a", XML.replace("7", "-1")), tmp_path / "b")) == LONGEST_PATH


def peer_python(folder: Path, body: str) -> str:
    """A program in place of a Python with a peer: called with the peer's script and its arguments."""
    program = folder / "python"
    head = f"#!{sys.executable}\nimport sys\nimport numpy as np\n"
    program.write_text(f"{head}size, numbers, out = sys.argv[3], sys.argv[5], sys.argv[6]\n{body}")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    return str(program)


FAKE_PEER = """counts = np.array([int(n) for n in numbers.split(',')])
width, height = map(int, size.split('x'))
rng = np.random.default_rng(len(counts))
reference = np.random.default_rng(1).uniform(0.2, 2, (height, width, 3))
noise = rng.standard_normal((1, len(counts), height, width, 3)) / np.sqrt(10 * counts)[None, :, None, None, None]
np.savez(out, names=['Mitsuba, fake'], images=SCALE * (reference + noise), seconds=0.01 * counts[None])
"""


def test_peer_is_given_the_samples_that_fit_each_budget(tmp_path: Path) -> None:
    python = peer_python(tmp_path, FAKE_PEER.replace("SCALE", "1"))
    options = replace(OPTIONS, peers={"mitsuba": python}, seconds=1.6)
    measured_series, pictures = measure_peer("mitsuba", scene_in(tmp_path / "a"), REFERENCE, options)
    assert measured_series.name == "Mitsuba, fake"
    assert [point.spp for point in measured_series.points] == 2 * [10, 20, 40, 80, 160]
    assert [point.seed for point in measured_series.points] == 5 * [0] + 5 * [1]
    assert set(pictures) == set(range(5))
    found = measured_series.slope("rel_mse")
    assert found is not None
    assert found == pytest.approx(-1, abs=0.1)


def test_peer_that_draws_another_picture_is_refused(tmp_path: Path) -> None:
    options = replace(OPTIONS, peers={"mitsuba": peer_python(tmp_path, FAKE_PEER.replace("SCALE", "1.1"))})
    with pytest.raises(Refused, match="another picture"):
        measure_peer("mitsuba", scene_in(tmp_path / "a"), REFERENCE, options)
    noise = 0.3 * np.random.default_rng(3).standard_normal((4, *REFERENCE.shape))
    check_same_picture(REFERENCE + noise, [1] * 4, REFERENCE)


def test_peer_that_is_missing_or_cannot_read_the_scene_is_refused_with_its_reason(tmp_path: Path) -> None:
    scene = scene_in(tmp_path / "a")
    with pytest.raises(Refused, match="LUXCORE_PYTHON names no Python"):
        measure_peer("luxcore", scene, REFERENCE, replace(OPTIONS, peers={"luxcore": None}))
    with pytest.raises(Refused, match="the scene cannot be told to it"):
        measure_peer("cycles", scene, REFERENCE, replace(OPTIONS, peers={"cycles": sys.executable}))
    other = replace(scene, entry="a.glb", files={"a.glb": scene.path.with_suffix(".glb")})
    with pytest.raises(Refused, match="only XML"):
        measure_peer("mitsuba", other, REFERENCE, replace(OPTIONS, peers={"mitsuba": sys.executable}))
    with pytest.raises(PeerFailed, match="boom"):
        python = peer_python(tmp_path, "sys.exit('boom')")
        run_peer("mitsuba", python, scene.path, (2, 2), 3, [1], tmp_path / "out.npz")
    with pytest.raises(PeerFailed, match="cannot be run"):
        run_peer("mitsuba", str(tmp_path / "nothing"), scene.path, (2, 2), 3, [1], tmp_path / "out.npz")
