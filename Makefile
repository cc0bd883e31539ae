# Every target does its own set-up: packages, virtual environment, build. Works on a bare Debian 12 or Ubuntu 24.04.
SHELL := bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := build
.PHONY: build demo test test-fast lint format bench chart stability asan tsan fuzz clean FORCE

VENV := .venv
PYTHON := $(VENV)/bin/python
PYTEST := $(PYTHON) -m pytest -c service/pyproject.toml --rootdir .
CPP_FILES = $(shell git ls-files 'engine/*.cpp' 'engine/*.h' 'tests/engine/*.cpp' 'tests/engine/*.h' 'tests/benchmarks/*.cpp' 'tests/benchmarks/*.h' 'tests/fuzz/*.cpp' 'tests/fuzz/*.h')
SCENES_DATA := $(or $(FLUXFARM_SCENES_DATA),../shared/scenes-data)

# Build everything: .venv/bin/fluxfarm and .venv/bin/fluxfarm-engine exist afterwards.
build: $(VENV)/.ready build/release/.configured
	cmake --build build/release
	ln -sfn ../../build/release/fluxfarm-engine $(VENV)/bin/fluxfarm-engine

# The main job: an embedded service renders a real scene, with a progress bar, to an EXR and a PNG.
demo: build
	mkdir -p out
	$(VENV)/bin/fluxfarm render scenes/cornell-glass/scene.xml -o out/cornell-glass.exr --png out/cornell-glass.png --spp 256
	@echo "Look at out/cornell-glass.png; out/cornell-glass.exr holds all layers."

# What CI runs: engine tests, then service, contract and render tests (short versions of the slow ones).
test: build
	ctest --test-dir build/release -j 2 --output-on-failure --no-tests=error
	$(PYTEST) -m "not slow" tests/service tests/contract tests/render tests/stability

# Only what answers within seconds.
test-fast: build
	ctest --test-dir build/release -j 2 --output-on-failure --no-tests=error -LE materials
	$(PYTEST) -m "not slow" -x tests/service/test_schedule.py tests/service/test_tiles.py tests/contract

# Style and static checks: clang-format, clang-tidy, ruff, mypy.
lint: build
	tools/setup-apt lint
	clang-format --dry-run --Werror $(CPP_FILES)
	tools/tidy build/release
	$(VENV)/bin/ruff check --config service/pyproject.toml service tests
	$(VENV)/bin/ruff format --check --config service/pyproject.toml service tests
	cd service && ../$(VENV)/bin/mypy

# Rewrite the code in the house's layout.
format: $(VENV)/.ready
	tools/setup-apt lint
	clang-format -i $(CPP_FILES)
	$(VENV)/bin/ruff check --fix --config service/pyproject.toml service tests
	$(VENV)/bin/ruff format --config service/pyproject.toml service tests

# Ray rates against bare Embree; a thousand emitters against ten; time to equal error against Mitsuba 3, Cycles and LuxCore where
# PEER_PYTHON, CYCLES_PYTHON, LUXCORE_PYTHON have them.
bench: build
	$(PYTHON) tests/benchmarks/bench.py --out out/bench.json

# Speed against accuracy: true error over time of each method and peer on our scenes, and on outside ones where they are:
# out/chart/index.html. CHART has the options; those of the chart that is kept are in docs/chart/README.md.
CHART := --seconds 8 --size 256x256 --reference-spp 2048
CHART_SCENES = $(wildcard scenes/*/scene.xml) tests/benchmarks/plates.xml $(wildcard $(foreach end,xml glb,$(SCENES_DATA)/*/scene.$(end)))
chart: build
	$(VENV)/bin/fluxfarm chart $(CHART_SCENES) --peers mitsuba,cycles,luxcore $(CHART)

# The slow statistical and fault suites.
stability: build
	$(PYTEST) -m slow --timeout 3600 tests/service tests/contract tests/render tests/stability

# The engine's tests under the address and undefined-behaviour sanitizers, or the thread sanitizer.
asan: PRESET := asan-ubsan
tsan: PRESET := tsan
asan tsan: $(VENV)/.ready
	cd engine && cmake --preset $(PRESET)
	cmake --build build/$(PRESET)
	cd engine && ctest --preset $(PRESET)

# Readers of scenes on made-up input, under the address and undefined-behaviour sanitizers: seconds of each, and which ones.
FUZZ := 600
fuzz: $(VENV)/.ready
	tools/setup-apt fuzz
	cd engine && cmake --preset fuzz
	cmake --build build/fuzz --target fuzz_xml fuzz_json fuzz_gltf fuzz_ply fuzz_obj fuzz_protocol
	tests/fuzz/run build/fuzz $(FUZZ)

clean:
	rm -rf build out $(VENV)

# Python packages at the locked versions and hashes, then the service itself and its side of the protocol.
$(VENV)/.ready: service/requirements-dev.lock service/pyproject.toml service/tools/generate_protocol.py $(wildcard proto/fluxfarm/v1/*.proto) tools/setup-apt
	tools/setup-apt build
	[ -x $(PYTHON) ] || python3 -m venv $(VENV)
	$(PYTHON) -m pip install -q --disable-pip-version-check --require-hashes -r service/requirements-dev.lock
	$(PYTHON) -m pip install -q --disable-pip-version-check --no-deps --no-build-isolation -e service
	$(PYTHON) service/tools/generate_protocol.py
	touch $@

build/release/.configured: engine/CMakeLists.txt engine/CMakePresets.json $(VENV)/.ready
	cd engine && cmake --preset release
	touch $@
