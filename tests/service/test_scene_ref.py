"""How engine processes are told of a job's scene, above all of a method that is still to be chosen."""

from dataclasses import replace
from pathlib import Path

from test_ledger import REQUEST

from fluxfarm.adapters.engine import codec
from fluxfarm.adapters.protocol import engine_pb2 as pb
from fluxfarm.domain.goal import Goal
from fluxfarm.domain.leases import Picture
from fluxfarm.domain.scene import SceneBundle
from fluxfarm.domain.tiles import PixelRect
from fluxfarm.orchestrator.dispatch import scene_ref

FOLDER = Path("/scene")
AUTO = replace(REQUEST, integrator="auto", goal=Goal(rel_error=0.05), crop=PixelRect(1, 2, 3, 4))


def test_a_method_is_chosen_for_a_picture_and_kept_under_the_same_key() -> None:
    asked = scene_ref(AUTO, FOLDER, None)
    assert asked.picture == Picture(AUTO.crop, AUTO.seed, AUTO.goal)
    told = asked.with_method("irradiance-cache")
    assert (told.key, told.integrator, told.picture) == (asked.key, "irradiance-cache", None)
    assert scene_ref(AUTO, FOLDER, "irradiance-cache") == told, "a restart must not choose again"


def test_gltf_has_no_method_of_its_own_so_one_is_chosen() -> None:
    bare = replace(REQUEST, bundle=SceneBundle("Chair.GLB", {"Chair.GLB": "0" * 64}))
    asked = scene_ref(bare, FOLDER, None)
    assert (asked.integrator, asked.picture) == ("auto", Picture(None, bare.seed, bare.goal))
    assert scene_ref(replace(bare, integrator="path"), FOLDER, None).integrator == "path"
    assert scene_ref(REQUEST, FOLDER, None).integrator == "", "a Mitsuba scene has one"


def test_another_picture_has_another_key() -> None:
    others = [
        replace(AUTO, seed=1),
        replace(AUTO, crop=None),
        replace(AUTO, goal=Goal(spp=4)),
        replace(AUTO, size=(8, 8)),
    ]
    keys = {scene_ref(request, FOLDER, None).key for request in (AUTO, *others)}
    assert len(keys) == 5


def test_jobs_with_a_named_method_share_their_scene() -> None:
    named = replace(AUTO, integrator="path")
    first, second = scene_ref(named, FOLDER, None), scene_ref(replace(named, seed=1), FOLDER, "path")
    assert first == second
    assert first.with_method("photon") == first


def test_the_picture_travels_with_its_scene() -> None:
    request = pb.Request.FromString(codec.load_scene(5, scene_ref(AUTO, FOLDER, None))[4:])
    picture = request.load_scene.picture
    assert request.load_scene.integrator == "auto"
    assert (picture.seed, picture.WhichOneof("goal"), picture.rel_error) == (AUTO.seed, "rel_error", 0.05)
    assert (picture.crop.x, picture.crop.y, picture.crop.width, picture.crop.height) == (1, 2, 3, 4)
    none = pb.Request.FromString(
        codec.load_scene(5, scene_ref(replace(AUTO, goal=Goal(), crop=None), FOLDER, None))[4:]
    )
    assert none.load_scene.picture.WhichOneof("goal") is None
    assert not none.load_scene.picture.HasField("crop")
    named = pb.Request.FromString(codec.load_scene(5, scene_ref(REQUEST, FOLDER, None))[4:])
    assert not named.load_scene.HasField("picture")
