# `make help` lists what there is. Everything runs on Debian's own Python, as YADE does.
PYTHON  ?= /usr/bin/python3
YADE    ?= yade
# Without the number of threads below, which nproc would take for that of the processors where make (since 4.4) hands it on.
JOBS    ?= $(shell env -u OMP_NUM_THREADS nproc)
# FULL=1: the full tables, hours; stop and start again at will. STUDY=name: one study only.
FULL    ?=
STUDY   ?=
REPORT  ?= figures/report.html
# PUBLISHED=1: make report of the committed full run, without any run here.
PUBLISHED ?=
# One thread a process: runs of several threads are not repeatable, and two run beside each other.
export OMP_NUM_THREADS = 1

site     = $(shell $(PYTHON) -m site --user-site)
cpp      = $(wildcard cd_engine/*/*.[ch]pp cd_engine/core/*.inl tests/core/*.cpp)
packages = cd_engine yade_scripts analysis tests

help:
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-12s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

deps: ## install the Debian packages that are missing
	@.ci/install-packages run

build: deps ## compile the engine
	@flock cd_engine $(MAKE) --no-print-directory -C cd_engine -j $(JOBS) PYTHON=$(PYTHON)

study: build ## every study's runs and figures, a first version; FULL=1 the real one, STUDY=fig3 one of them
	$(PYTHON) yade_scripts/study.py $(if $(FULL),--full,--quick) $(addprefix --only ,$(STUDY)) --jobs $(JOBS)

sweep: build ## the rows of tables on a Slurm cluster: TABLE="yade_scripts/tables/fig3.txt ..." MINUTES=60 SBATCH="--partition=long"
	$(PYTHON) yade_scripts/cluster/sweep.py $(TABLE) $(if $(MINUTES),--minutes $(MINUTES)) $(if $(SBATCH),--sbatch='$(SBATCH)')

charts: build ## speed against accuracy, where each method fails: a first version; FULL=1 the real one
	$(PYTHON) yade_scripts/charts/run.py $(if $(FULL),--full,--quick) --jobs $(JOBS)
	$(if $(wildcard yade_scripts/maps/run.py),$(PYTHON) yade_scripts/maps/run.py $(if $(FULL),--full,--quick) --jobs $(JOBS))

report: deps ## one HTML page of the studies run so far; FULL=1 of the full tables, PUBLISHED=1 of the committed full run
	@$(PYTHON) -m analysis report $(if $(FULL),--full) $(if $(PUBLISHED),--published analysis/published) -o $(REPORT)

test: build ## all tests and the short regression run
	@.ci/install-packages test
	$(PYTHON) yade_scripts/regression.py --short
	$(PYTHON) -m pytest tests -n 2 -rs

soak: build ## what takes too long for `make test`: runs killed many times, damaged files by the thousand, long runs, the other releases of Debian
	@.ci/install-packages test soak
	$(PYTHON) -m pytest tests/soak

console: build ## YADE's console with the engine and the prepared packing
	$(YADE) yade_scripts/console.py

regression: build ## every scene, headless, against stored numbers
	$(PYTHON) yade_scripts/regression.py

bench: build ## the solvers beside Siconos's: time, sweeps, error, memory; QUICK=1 a minute, AGAIN=1 anew, FILES="..." more problems
	@.ci/install-packages test
	$(PYTHON) -m yade_scripts.benchmark $(if $(QUICK),--quick) $(if $(AGAIN),--again) $(if $(PUBLISH),--publish) $(FILES)

lint: ## style and static checks
	@.ci/install-packages lint
	$(PYTHON) -m pyflakes $(packages)
	$(if $(wildcard .clang-format),clang-format --dry-run --Werror $(cpp))

install: build ## let every YADE console of this user import cd_engine
	install -d $(site)/cd_engine/core
	install -m 644 cd_engine/*.py cd_engine/*.so $(site)/cd_engine
	install -m 644 cd_engine/core/*.py cd_engine/core/*.so $(site)/cd_engine/core

uninstall: ## undo `make install`
	rm -rf $(site)/cd_engine

clean: ## remove what was compiled; results stay
	$(MAKE) --no-print-directory -C cd_engine clean

.PHONY: help deps build study sweep charts report test soak console regression bench lint install uninstall clean
