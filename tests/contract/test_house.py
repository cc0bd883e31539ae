"""What the repository promises about itself."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TARGETS = [
    "build",
    "demo",
    "test",
    "test-fast",
    "lint",
    "format",
    "bench",
    "chart",
    "stability",
    "asan",
    "tsan",
    "fuzz",
]


def text(name: str) -> str:
    return (ROOT / name).read_text()


def tracked_files() -> list[Path]:
    if not (ROOT / ".git").exists():
        pytest.skip("not a git checkout: the tracked files are not known")
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return [ROOT / name for name in listed.split("\0") if name and (ROOT / name).is_file()]


def test_makefile_has_every_target() -> None:
    for target in TARGETS:
        assert re.search(rf"^([\w-]+ )*{target}( [\w-]+)*:", text("Makefile"), re.MULTILINE), target


def test_ci_runs_what_make_test_runs() -> None:
    assert "make test" in text(".ci/run")


def test_readme_names_the_two_commands_and_every_folder_of_code() -> None:
    readme = text("README.md")
    assert "make demo" in readme
    assert "make test" in readme
    for folder in ("engine", "service", "proto", "scenes", "tests"):
        assert f"{folder}/README.md" in readme
        assert (ROOT / folder / "README.md").exists()


def test_every_test_that_the_readme_names_exists() -> None:
    for name in re.findall(r"`(tests/[\w/.]+)`", text("README.md")):
        assert (ROOT / name).exists(), name


def test_every_link_of_a_page_leads_to_something() -> None:
    for page in (file for file in tracked_files() if file.suffix == ".md"):
        for target in re.findall(r"\]\(([^)#:\s]+)\)", page.read_text()):
            assert (page.parent / target).exists(), f"{page.relative_to(ROOT)}: {target}"


def test_every_scene_is_described() -> None:
    for scene in (ROOT / "scenes").iterdir():
        if scene.is_dir():
            assert f"`{scene.name}`" in text("scenes/README.md")
            assert (scene / "scene.xml").exists()


def test_container_is_built_by_the_scripts_that_make_uses() -> None:
    assert "tools/setup-apt build" in text("Dockerfile")
    assert "make build" in text("Dockerfile")
    assert "tools/setup-apt build" in text("Makefile")


def test_compose_file_publishes_the_service_to_this_machine_only() -> None:
    compose = text("docker-compose.yml")
    assert re.search(r"^services:\n {2}fluxfarm:\n", compose, re.MULTILINE)
    assert re.findall(r'- "([^"]+:\d+:\d+)"', compose) == ["127.0.0.1:8460:8460", "127.0.0.1:8461:8460"]
    assert "\t" not in compose


@pytest.mark.parametrize("file", sorted((ROOT / "tests" / "benchmarks").glob("*.py")), ids=lambda file: file.name)
def test_benchmark_finds_all_that_it_imports(file: Path) -> None:
    """They are run by hand and by no test, so that a name that has moved would go unnoticed."""
    command = [sys.executable, "-c", f"import {file.stem}"]
    done = subprocess.run(command, cwd=file.parent, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


# Written in pieces, so that this file is not found by its own search.
INDEX_HOSTS = ["py" + "pi.org", "pythonhosted" + ".org", "registry.npmjs" + ".org", "deb.debian" + ".org"]
INDEX_OPTIONS = ["--index" + "-url", "--extra-index" + "-url"]
MACHINE_PATH = re.compile(r"(^|[^A-Za-z0-9_.])/(" + "wo" + "rk|ro" + r"ot|home/\w+)/")


def test_no_tracked_file_names_a_package_index_or_a_path_of_a_machine() -> None:
    for file in tracked_files():
        if file.suffix in {".png", ".exr", ".jpg", ".ply", ".glb", ".bin"}:
            continue
        content = file.read_text()
        for word in INDEX_HOSTS + INDEX_OPTIONS:
            assert word not in content, f"{file.relative_to(ROOT)}: {word}"
        found = MACHINE_PATH.search(content)
        assert found is None, f"{file.relative_to(ROOT)}: {found and found[0]}"
