# What can be done here, each in one word. `make run` and `make test` need git, make and python3, and get the rest.

VENV := .venv/bin
export PYRIGHT_PYTHON_IGNORE_WARNINGS := 1
# Kept over clones: it goes by what the sources hold, not by where they lie.
export MYPY_CACHE_DIR ?= $(or $(XDG_CACHE_HOME),$(HOME)/.cache)/giraff/mypy

COMPILE := $(VENV)/uv pip compile pyproject.toml --quiet --universal --python-version 3.11 --generate-hashes \
	--no-emit-index-url --no-emit-find-links --custom-compile-command "make lock" $(ARGS)
# What one kind of host needs, in the versions that everything is tested with.
PART := $(COMPILE) --constraint requirements/dev.lock --group build

.PHONY: help setup run viewer camera wheel test test-hosts test-timing bench lint mypy pyright format campaign mutants lock install clean

help: ## List the targets
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | expand -t 12

run: ## Drive the simulated robot, e.g. make run ARGS="--for 30"; installs what that needs
	@scripts/setup run
	@$(VENV)/giraff run $(ARGS)

viewer: ## Add the library of giraff view: 220 MB to download, 670 on the disk
	@scripts/setup viewer

camera: ## Add OpenCV, for giraff run --camera, giraff vision and giraff calibrate camera
	@scripts/setup camera

setup: ## Install and build whatever a run or a test needs; skips what is there
	@scripts/setup all

test: setup ## Everything that must hold on one host before a commit lands; about 6 minutes on two cores
	@tests/run $(ARGS)

lint: setup ## Style and types
	$(VENV)/ruff check
	$(VENV)/ruff format --check
	@$(MAKE) --no-print-directory --jobs=2 --output-sync mypy pyright

mypy pyright:
	$(VENV)/$@

format: setup ## Put the Python sources into their one form
	$(VENV)/ruff check --fix
	$(VENV)/ruff format

campaign: setup ## Hours: thousands of seeds and rooms, random bytes, every mutant; figures in build/campaign
	$(VENV)/pytest tests/campaign tests/mutants --timeout=0 --capture=no $(ARGS)

mutants: setup ## Each safety rule broken, its test must fail, e.g. make mutants ARGS="--sample 40", ARGS="-k guard"
	$(VENV)/pytest tests/mutants --timeout=0 --numprocesses=logical $(ARGS)

test-timing: setup ## What the wall clock judges, by hand, on a quiet machine; ARGS=tests/timing/long for the longest
	@tests/timing/run $(ARGS)

bench: setup ## What services cost beside bare Zenoh, 5 minutes on a quiet machine; ARGS="--rounds 1 --only pairs"
	@$(VENV)/python -m bench $(ARGS)

test-hosts: setup ## docker-compose up on three hosts of this machine, as root; cables cut, power lost
	@tests/hosts/run $(ARGS)

lock: setup ## Pin what pyproject.toml asks for; ARGS=--upgrade takes the newest
	$(COMPILE) --all-extras --group dev --output-file requirements/dev.lock
	$(PART) --extra serial --output-file requirements/robot.lock
	$(PART) --extra serial --extra record --output-file requirements/recorder.lock
	$(PART) --extra serial --extra web --output-file requirements/web.lock
	$(PART) --extra serial --extra localization --output-file requirements/localization.lock
	$(PART) --extra serial --extra camera --output-file requirements/camera.lock
	$(PART) --extra serial --extra ros2 --output-file requirements/ros2.lock
	$(PART) --extra serial --extra cli --extra web --extra localization --extra camera --extra ros2 \
		--output-file requirements/laptop.lock
	$(PART) --extra serial --extra cli --extra sim --extra web --extra localization --extra camera \
		--output-file requirements/sim.lock
	$(PART) --extra serial --extra cli --extra sim --extra web --extra localization --extra record --extra keys \
		--extra ros2 --output-file requirements/run.lock
	$(PART) --extra viewer --output-file requirements/viewer.lock

wheel: ## Build dist/giraff-*.whl, the command line for another machine: docs/install.md
	@scripts/setup run
	@rm -rf dist
	@$(VENV)/pip wheel --quiet --no-deps --no-build-isolation --wheel-dir dist .
	@ls dist/*.whl

install: ## Without containers, as root: make install ROLE=robot (or laptop); DESTDIR=DIR for a look; docs/install.md
	@scripts/install

clean: ## Remove everything that setup and the tests made
	rm -rf build dist .venv .hypothesis .import_linter_cache .mypy_cache .pytest_cache .ruff_cache
