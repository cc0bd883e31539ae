"""A job from its submission to its image."""

from collections.abc import Callable

from farm_client import Client

SCENE = "fake: size 64 48\nfake: spp 8\n"


def test_job_goes_from_post_to_image(client: Client) -> None:
    job_id = client.submit(SCENE, name="first")
    job = client.succeed(job_id)
    assert job["progress"]["tiles_done"] == 4 * 3 * 4
    assert job["progress"]["tiles_total"] == 4 * 3 * 4
    assert job["progress"]["samples_done"] == 64 * 48 * 8
    assert job["size"] == {"width": 64, "height": 48}
    image = client.http.get(f"/v1/jobs/{job_id}/image.exr")
    assert image.content[:4] == b"\x76\x2f\x31\x01"
    assert image.headers["x-fluxfarm-samples"] == "8"
    assert client.http.get(f"/v1/jobs/{job_id}/preview.png").content[:4] == b"\x89PNG"


def test_image_is_identical_for_any_number_of_workers(start: Callable[..., Client], tmp_path) -> None:
    one = start(data=tmp_path / "one").render(SCENE)
    many = start(data=tmp_path / "many", workers=3).render(SCENE)
    assert one == many
