# `make` lists what there is. Everything runs on Debian's own Python, as YADE does.
PYTHON  ?= /usr/bin/python3
# Without OMP_NUM_THREADS: since 4.4 make passes the value exported below to nproc, which would then print 1, not the number of processors.
JOBS    ?= $(shell env -u OMP_NUM_THREADS nproc)
# FULL=1: the full tables, hours; stop and start again at will. STUDY=name: one study only.
FULL    ?=
STUDY   ?=
# HOURS=3: end a run that takes longer; the next call continues it.
HOURS   ?=
REPORT  ?= figures/report.html
# PUBLISHED=1: make report of the committed full run, without any run here.
PUBLISHED ?=
# One thread a process: runs of several threads are not repeatable, and two run beside each other.
export OMP_NUM_THREADS = 1

# YADE does not start without a home.
export HOME := $(or $(HOME),/tmp)

# Whether a setting is on: FULL=0 and FULL=no are not.
on       = $(filter-out 0 no,$(1))
extent   = $(if $(call on,$(FULL)),--full,--quick)
site     = $(shell $(PYTHON) -m site --user-site)
cpp      = $(wildcard cd_engine/*/*.[ch]pp cd_engine/*/*/*.[ch]pp cd_engine/core/*/*.inl tests/*/*.[ch]pp)
packages = cd_engine yade_scripts analysis tests
# What plain YADE scripts find defined.
yade     = O,box,sphere,readParamsFromTable,runningInBatch,kineticEnergy,PWaveTimeStep,Quaternion,FrictMat,Sphere,ForceResetter,InsertionSortCollider,$\
           Bo1_Sphere_Aabb,Bo1_Box_Aabb,InteractionLoop,Ig2_Sphere_Sphere_ScGeom,Ig2_Box_Sphere_ScGeom,Ip2_FrictMat_FrictMat_MindlinPhys,$\
           Law2_ScGeom_MindlinPhys_Mindlin,NewtonIntegrator,PyRunner,RotationEngine,Vector3,Bo1_Facet_Aabb,Bo1_Wall_Aabb,Ig2_Facet_Sphere_ScGeom,$\
           Ig2_Wall_Sphere_ScGeom,Ip2_FrictMat_FrictMat_FrictPhys,Law2_ScGeom_FrictPhys_CundallStrack,unbalancedForce,wall

help: ## this list
	@echo 'Every target installs the Debian packages that it needs and builds the engine where that is out of date.'
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-11s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)
	@echo 'Settings: FULL=1 the whole tables, hours, to be stopped and started again at will; STUDY="fig3 fig4" some studies only;'
	@echo '          PUBLISHED=1 with make report: of the committed run; JOBS=1 one run at a time; HOURS=3 with make study: none longer.'

deps: ## install the Debian packages that are missing
	@.ci/install-packages run

build: deps ## compile the engine
	@flock cd_engine $(MAKE) --no-print-directory -C cd_engine -j $(JOBS) PYTHON=$(PYTHON)

study: build ## prepare packings, run MD and CD, draw the figures: a first version in 5 to 15 minutes; FULL=1, STUDY=fig3
	$(PYTHON) -m analysis study --run $(extent) $(if $(HOURS),--hours $(HOURS)) $(STUDY) --jobs $(JOBS)

report: deps ## one HTML page of the studies run so far; FULL=1, PUBLISHED=1
	@$(PYTHON) -m analysis report $(if $(call on,$(PUBLISHED)),--published analysis/published,$(extent)) -o "$(REPORT)"

charts: build ## measure and draw speed against accuracy, and where each method fails: about 20 minutes; FULL=1
	$(PYTHON) -m yade_scripts.measuring $(extent) --jobs $(JOBS)
	$(PYTHON) -m analysis charts $(extent)

test: build ## all tests and the quick regression run: about 10 minutes on two cores
	@.ci/install-packages test
	$(PYTHON) yade_scripts/measuring/regression.py --quick
	$(PYTHON) -m pytest tests -n 2 --dist loadfile -rs

debug: deps ## compile the engine with asserts, to find a fault in it; `make build` then brings the released one back
	@flock cd_engine $(MAKE) --no-print-directory -C cd_engine -j $(JOBS) PYTHON=$(PYTHON) debug

soak: build ## what takes too long for `make test` or starts daemons: Slurm, kills, damaged files, sanitizers, other releases of Debian
	@.ci/install-packages test soak
	$(PYTHON) -m pytest tests/soak

console: build ## YADE's console with the engine and the prepared packing
	yade yade_scripts/console.py

regression: build ## run 24 cases of 18 scenes without a window and compare their results with stored numbers
	$(PYTHON) yade_scripts/measuring/regression.py --full

bench: build ## measure the contact solvers beside Siconos's, some two minutes; FULL=1; AGAIN=1 repeats all, FILES="..." adds problems
	@.ci/install-packages test
	$(PYTHON) -m yade_scripts.measuring.benchmark $(extent) $(if $(call on,$(AGAIN)),--again) $(FILES)
	$(PYTHON) -m analysis benchmark results/benchmark$(if $(call on,$(FULL)),,/quick)

sweep: build ## the rows of tables, or of STUDY="fig3", on a Slurm cluster: TABLE="a.txt b.txt" MINUTES=60 SBATCH="--partition=long"
	@mkdir -p results
	@$(foreach study,$(STUDY),$(PYTHON) -m analysis table $(study) $(extent) > results/$(study).txt &&) true
	$(PYTHON) yade_scripts/cluster/sweep.py $(TABLE) $(STUDY:%=results/%.txt) $(if $(MINUTES),--minutes $(MINUTES)) $(if $(SBATCH),--sbatch='$(SBATCH)')

lint: ## style and static checks
	@.ci/install-packages lint
	@$(PYTHON) -m pyflakes $(shell find $(packages) -name '*.py' -not -path '*/examples/*')
	@PYFLAKES_BUILTINS=$(yade) $(PYTHON) -m pyflakes yade_scripts/examples
	@! LC_ALL=C.UTF-8 grep -rnE --include='*.py' '^.{151,}' $(packages)  # longer than 150 columns, as .clang-format has it for C++
	clang-format --dry-run --Werror $(cpp)

install: build ## let every YADE console of this user import cd_engine
	install -d "$(site)/cd_engine/core/files" "$(site)/cd_engine/pictures"
	install -m 644 cd_engine/pictures/*.py "$(site)/cd_engine/pictures"
	install -m 644 cd_engine/*.py cd_engine/*.so "$(site)/cd_engine"
	install -m 644 cd_engine/core/*.py cd_engine/core/*.so "$(site)/cd_engine/core"
	install -m 644 cd_engine/core/files/*.py "$(site)/cd_engine/core/files"

uninstall: ## undo `make install`
	@test -n "$(site)" || { echo '$(PYTHON) does not tell where its packages of this user lie'; exit 1; }
	rm -rf "$(site)/cd_engine"

clean: ## remove what was compiled; results stay
	$(MAKE) --no-print-directory -C cd_engine clean

.PHONY: help deps build study sweep charts report test soak console regression bench lint install uninstall clean
