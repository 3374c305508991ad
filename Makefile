# mavboat: every target sets up what it needs. Only git, make and Python 3.11 with venv are assumed.
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
STAMP  := $(VENV)/.installed

.DEFAULT_GOAL := help
.PHONY: help setup wheel demo survey pictures test test-quick check lint types contracts mutate bench fuzz clean

help:  ## list the targets
	@awk -F':.*## ' '/^[a-z-]+:.*## / {printf "  make %-10s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

setup: $(STAMP)  ## create .venv with the tested set of packages

# A kernel that is older than its source would give other results than its twin in Python
KERNELS := $(wildcard companion/planning/*.py companion/planning/*.pxd)

$(STAMP): pyproject.toml setup.py constraints.txt requirements-peers.txt $(KERNELS)
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "mavboat needs Python 3.11 or later; '$(PYTHON)' is older: call make PYTHON=python3.11"; exit 2; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]'
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps -r requirements-peers.txt
	@touch $@

wheel: setup  ## one wheel for every machine, without compiled kernels, in out/wheel
	rm -rf build/lib  # may hold files that were moved since
	MAVBOAT_PURE=1 $(BIN)/python -m pip wheel --quiet --disable-pip-version-check --no-deps --wheel-dir out/wheel .

demo: setup  ## plan, upload, sail, report; also MAP=… START=LAT,LON GOAL=LAT,LON
	$(BIN)/python examples/demo.py --map '$(or $(MAP),lake)' $(if $(START),--start='$(START)') $(if $(GOAL),--goal='$(GOAL)') $(if $(CLEARANCE),--clearance='$(CLEARANCE)')

survey: setup  ## plan a survey, sail it, chart the lake, compare with the truth; also FOOTPRINT=M OVERLAP=SHARE SEED=N
	$(BIN)/python examples/survey.py $(if $(FOOTPRINT),--footprint $(FOOTPRINT)) $(if $(OVERLAP),--overlap $(OVERLAP)) $(if $(SEED),--seed $(SEED))

pictures: demo survey  ## make the pictures of the documents anew
	mkdir -p docs/pictures
	cp out/demo.png docs/pictures/demo.png
	cp out/survey.png docs/pictures/survey.png
	PYTHONPATH=docs $(BIN)/python -m pictures
	PYTHONPATH=docs $(BIN)/python -m pictures shore
	$(BIN)/mission-plan lake --survey all --footprint 24 --overlap 0.15 --boat kit --split --preview docs/pictures/split.png
	cp out/chart/chart.png docs/pictures/depth_chart.png
	$(BIN)/boat-sitl sail pool --case 2 --png docs/pictures/pool.png
	$(BIN)/boat-sitl sail random --seed 8 --fence --png docs/pictures/random.png

QUICK := control core estimation guidance geofence obstacles payload rc sensors failsafe calibration links mavlink

test-quick: setup  ## unit tests of the boat's arithmetic and rules, with a few examples a property, in a minute
	$(BIN)/python -m pytest -q -n 2 --dist worksteal --hypothesis-profile=quick -m "not slow and not realtime" \
		$(addprefix tests/companion/,$(QUICK))

test: setup  ## all tests
	$(BIN)/python -m pytest -n 3 --dist worksteal

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: setup
	$(BIN)/mypy

contracts: setup
	$(BIN)/lint-imports --no-cache

check: lint types contracts test  ## lint, types, import contracts, tests

mutate: setup  ## mutation testing of the boat's packages; also SAMPLE=200 (0: all), SEED=1, PACKAGE='control services/ftp'
	$(BIN)/python tests/mutation --sample '$(or $(SAMPLE),200)' $(if $(SEED),--seed $(SEED)) $(addprefix --package ,$(PACKAGE))

bench: setup  ## side by side with peers; writes out/benchmarks.md
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[bench]'
	@# it asks for numpy 1, and runs with 2
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps -c constraints.txt extremitypathfinder
	$(BIN)/python -m benchmarks

fuzz: setup  ## coverage-guided fuzzing; also FUZZ_SECONDS=60 for each target, TARGETS='files nmea'
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[fuzz]'
	PYTHONPATH=tests $(BIN)/python -m fuzz --seconds '$(or $(FUZZ_SECONDS),60)' $(TARGETS)

clean:  ## remove everything that make made
	rm -rf $(VENV) out build .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find companion -name '*.so' -delete
