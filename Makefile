# make          the whole steering study and its report
# make small    the same study, shrunk to about two minutes
# make resampled the same study on walks resampled from recordings, its verdicts beside those of make (needs WALKLAB_DATA)
# make real     leave-one-subject-out on real walks (needs WALKLAB_DATA)
# make replicates   the study on 20 synthetic populations, without figures and ablations
# make recovery     does the method recover a known distribution? walks made by the planner itself
# make multiverse   the study under other readings of the paper and other constants of the capture: results/multiverse
# make test     all tests but the slow ones      make test-all   these too      make lint   all checks of style and structure
# make bench    every benchmark beside its baseline: results/bench/summary.json, scaling.png
# make track    log a finished run to MLflow (RUN=results/steering, URI=...)
# make crate    pack it as a Workflow Run RO-Crate
# make large    capture, maps and blending space of 50 000 walks, and of a quarter of them
# make sizing   what 10^3 to 10^7 walks cost, from the two runs of make large: docs/cluster.md
# make model-card  docs/model-card.md, from the runs of make and make real
# make docs     the documentation as a site: build/site      make audit   known holes in locked packages
# make container   the Containerfile, from the lock file
# make manual   config/README.md, docs/data.md      make lock   the lock files
# make clean    remove results and the environment

PYTHON ?= python3
BIN := .venv/bin
SNAKEMAKE := $(BIN)/snakemake
export WALKLAB_DATA ?= ../shared/data

.PHONY: all small resampled real own multiverse replicates recovery test test-all bench track crate large sizing lint manual model-card docs audit container lock clean
.DEFAULT_GOAL := all

all: .venv/ready
	$(SNAKEMAKE)
	$(SNAKEMAKE) --report results/steering/snakemake_report.zip

small: .venv/ready
	$(SNAKEMAKE) --configfile config/small.yaml
	$(SNAKEMAKE) --configfile config/small.yaml --report results/small/snakemake_report.zip

resampled: .venv/ready
	$(SNAKEMAKE) results/steering/claims.csv
	$(SNAKEMAKE) --configfile config/resampled.yaml
	$(SNAKEMAKE) --configfile config/resampled.yaml --report results/resampled/snakemake_report.zip

real: .venv/ready
	$(SNAKEMAKE) --configfile config/cmu.yaml
	$(SNAKEMAKE) --configfile config/cmu.yaml --report results/cmu/snakemake_report.zip

own: .venv/ready
	$(SNAKEMAKE) --configfile config/own.yaml
	$(SNAKEMAKE) --configfile config/own.yaml --report results/own/snakemake_report.zip

replicates: .venv/ready
	$(SNAKEMAKE) --configfile config/replicates.yaml
	$(SNAKEMAKE) --configfile config/replicates.yaml --report results/replicates/snakemake_report.zip

recovery: .venv/ready
	$(SNAKEMAKE) recovery --configfile config/recovery.yaml
	$(SNAKEMAKE) recovery --configfile config/recovery.yaml --report results/recovery/snakemake_report.zip

multiverse: .venv/ready
	$(SNAKEMAKE) multiverse
	$(SNAKEMAKE) multiverse --report results/multiverse/snakemake_report.zip

# One call, the longest files first. A third worker makes it no faster on two cores (tried).
test: .venv/ready .venv/tracking .venv/validator/ready
	$(BIN)/python -m pytest tests/workflow tests/unit tests/examples tests/security -n 2 --dist loadfile --no-loadscope-reorder -m "not slow"

# With the simulators, so that the examples that use them run.
test-all: .venv/ready .venv/tracking .venv/validator/ready .venv/peers/ready
	$(BIN)/python -m pytest tests/workflow tests/unit tests/examples tests/security -n 2 --dist loadfile --no-loadscope-reorder

# One core where a row says so, and the BLAS kernels that the processor wants: neither may slow a baseline.
BENCH := env -u OPENBLAS_CORETYPE -u OPENBLAS_L2_SIZE OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1

bench: .venv/ready .venv/peers/ready
	mkdir -p results/bench
	$(BENCH) $(BIN)/python -m pytest benchmarks -o pythonpath=benchmarks --benchmark-disable-gc \
	    --benchmark-json=results/bench/pytest-benchmark.json
	$(BENCH) $(BIN)/python benchmarks/bench_scaling.py
	$(BIN)/python benchmarks/summary.py

# Capture, maps and blending space of more than 50 000 walks, and of a quarter of them: two sizes, for make sizing.
large: .venv/ready
	$(SNAKEMAKE) --configfile config/quarter.yaml --until build_space
	$(SNAKEMAKE) --configfile config/large.yaml --until build_space

sizing: .venv/ready
	$(BIN)/python workflow/sizing.py results/quarter results/large --write

RUN ?= results/steering

track: .venv/tracking
	$(BIN)/walklab track $(RUN) $(if $(URI),--uri $(URI))

crate: .venv/tracking
	$(BIN)/walklab crate $(RUN)

lint: .venv/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/snakefmt --check Snakefile workflow/rules
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python workflow/lint.py
	$(BIN)/python workflow/manual.py --check
	$(BIN)/python workflow/container.py --check

manual: .venv/ready
	$(BIN)/python workflow/manual.py

model-card: .venv/ready
	$(BIN)/python workflow/model_card.py

docs: .venv/docs/ready
	.venv/docs/bin/zensical build --strict

# Asks a public service for advisories, so it needs the network; the packages are not installed for it.
audit: .venv/docs/ready
	$(BIN)/python workflow/audit.py

container: .venv/ready
	$(BIN)/python workflow/container.py

# What only the windows of the benchmarks' peers need: half a gigabyte.
QT := pyside6 pyside6-addons pyside6-essentials pyside6-pdf pyside6-webengine shiboken6 pyobjc-core pyobjc-framework-cocoa

# Needs uv. --no-emit-index-url keeps addresses of package registries out of the file.
lock:
	uv pip compile --universal --generate-hashes --no-header --no-emit-index-url --python-version 3.11 \
	    --extra dev --extra cluster pyproject.toml -o requirements.lock
	uv pip compile --universal --generate-hashes --no-header --no-emit-index-url --python-version 3.11 \
	    --extra tracking -c requirements.lock pyproject.toml -o requirements-tracking.lock
	printf '%s\n' rocrate roc-validator | uv pip compile --universal --generate-hashes --no-header --no-emit-index-url \
	    --python-version 3.11 - -o tests/validator.lock
	printf '%s\n' zensical pip-audit | uv pip compile --universal --generate-hashes --no-header --no-emit-index-url \
	    --python-version 3.11 - -o docs/tools.lock
	printf '%s\n' jupedsim pyrvo python_motion_planning | uv pip compile --universal --generate-hashes --no-header \
	    --no-emit-index-url --python-version 3.11 $(addprefix --no-emit-package ,$(QT)) - -o benchmarks/peers.lock

clean:
	rm -rf results .snakemake .venv .mypy_cache .ruff_cache .pytest_cache .import_linter_cache .hypothesis build

.venv/ready: requirements.lock pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit("walklab needs Python 3.11 or newer") if sys.version_info < (3, 11) else None'
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	touch $@

.venv/tracking: .venv/ready requirements-tracking.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements-tracking.lock
	touch $@

.venv/docs/ready: .venv/ready docs/tools.lock
	$(PYTHON) -m venv .venv/docs
	.venv/docs/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes -r docs/tools.lock
	touch $@

# The validator of RO-Crates wants older packages than Snakemake, so it lives by itself.
.venv/validator/ready: .venv/ready tests/validator.lock
	$(PYTHON) -m venv .venv/validator
	.venv/validator/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes -r tests/validator.lock
	touch $@

# What the benchmarks are held against, some of it under the GPL, lives by itself. --no-deps: its windows are left out.
.venv/peers/ready: .venv/ready benchmarks/peers.lock
	$(PYTHON) -m venv .venv/peers
	.venv/peers/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes -r benchmarks/peers.lock
	touch $@
