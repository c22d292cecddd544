# make demo | make test | make docs | make bench | make studies | make chaos | make check: each sets itself up (.venv, package indexes only).
PYTHON ?= $(shell for p in python3.12 python3.11 python3; do \
  if $$p -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 12))' 2>/dev/null; then echo $$p; break; fi; done)
VENV ?= .venv
BIN := $(VENV)/bin
OUT ?= out/demo
# Two more than cores: one runs the group of the graph, which waits for most of its time. Not measured against one more.
WORKERS ?= $(shell echo $$(( $$(nproc) + 2 )))
# A sourced Jazzy brings its own rclpy; only elsewhere do the wheels come from the package index.
ROS_EXTRA := $(if $(filter jazzy,$(ROS_DISTRO)),,ros,)

.PHONY: help demo test test-all check docs golden bench studies fuzz chaos clean
.DEFAULT_GOAL := help

help:
	@echo "make demo    run two tasks in the ROS 2 graph; leaves bags and their pages in $(OUT)"
	@echo "make test    the whole test suite with ruff, mypy and the import test"
	@echo "make test-all also the thorough forms of tests that make test has"
	@echo "make check   ruff and mypy only"
	@echo "make docs    serve the documentation as a site on http://127.0.0.1:8000"
	@echo "make studies every figure and table of the three papers, and the laws compared; leaves pages in out/studies"
	@echo "make golden  run the reference logs of the tests again, and say what is different"
	@echo "make fuzz    10,000 files and command lines that are nearly right: no traceback, no hang (CASES=, SEED=)"
	@echo "make chaos   kill and stop processes of runs, let nodes come late, fuzz, steer runs at random; takes two hours"
	@echo "make bench   speed of start, plant, loop, graph and log, written into docs/speed.md"

$(VENV)/bin/uv:
	@test -n "$(PYTHON)" || { echo "Python 3.11 or 3.12 is needed and was not found; set PYTHON=/path/to/python" >&2; exit 2; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install -q --disable-pip-version-check 'uv>=0.4'

$(VENV)/.run: pyproject.toml setup.py | $(VENV)/bin/uv
	$(BIN)/uv pip install -q --compile-bytecode --python $(BIN)/python -e '.[$(ROS_EXTRA)viz,view,robots,campaign,mpc,pandas]'
	@touch $@

$(VENV)/.dev: pyproject.toml setup.py | $(VENV)/bin/uv
	$(BIN)/uv pip install -q --compile-bytecode --python $(BIN)/python -e '.[$(ROS_EXTRA)dev]'
	@touch $(VENV)/.run $@

# Once in a clone and beside mypy, which takes one core.
$(VENV)/.warm: $(VENV)/.dev
	@$(BIN)/python -m tests.support.warm
	@touch $@

demo: $(VENV)/.run
	@mkdir -p $(OUT)
	$(BIN)/space-robot run liu2023/fig08 --mode graph --overwrite --out $(OUT)/fig08
	$(BIN)/space-robot run point_to_point/ur5_sat --mode graph --overwrite --out $(OUT)/ur5_sat
	$(BIN)/space-robot plot $(OUT)/fig08
	$(BIN)/space-robot report $(OUT)/fig08
	$(BIN)/space-robot report $(OUT)/ur5_sat

check: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

test:
	@$(MAKE) --no-print-directory -j2 check $(VENV)/.warm
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadgroup -m "not thorough"

test-all:
	@$(MAKE) --no-print-directory -j2 check $(VENV)/.warm
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadgroup

docs: $(VENV)/.dev
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs serve

golden: $(VENV)/.run
	$(BIN)/space-robot replay tests/data/golden/* --update-refs

CASES ?= 10000
SEED ?= 1
fuzz: $(VENV)/.dev
	$(BIN)/python -m tests.chaos.fuzz --cases $(CASES) --seed $(SEED)

bench: $(VENV)/.dev
	$(BIN)/python -m benchmarks --write docs/speed.md

studies: $(VENV)/.dev
	$(BIN)/space-robot reproduce liu2023 --out out/studies/liu2023
	$(BIN)/space-robot reproduce giordano2023 --out out/studies/giordano2023
	$(BIN)/space-robot reproduce song2023 --out out/studies/song2023
	$(BIN)/space-robot compare --out out/studies/compare

chaos: $(VENV)/.dev
	@for program in kill blows late fuzz steering; do $(BIN)/python -m tests.chaos.$$program || exit 1; done

clean:
	rm -rf $(VENV) build dist out *.egg-info .mypy_cache .ruff_cache .pytest_cache
