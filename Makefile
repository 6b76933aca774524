# Everything a fresh machine needs: `make demo` and `make test`. Python 3.11 or newer with its module venv is all they ask for.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
PIP    := $(BIN)/pip install --quiet --disable-pip-version-check --constraint constraints.txt
# An environment that is half made, or whose Python is gone, is made anew; one sentence where Python cannot make any.
SUITS    = import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))
UNSUITED = Trisect needs Python 3.11 or newer with its modules venv and ensurepip, which "$(PYTHON)" is not: install them (on Debian and Ubuntu: apt install python3 python3-venv), or name another one (make PYTHON=/path/to/python3)
define ENVIRONMENT
@$(PYTHON) -c '$(SUITS)' 2>/dev/null || { echo '$(UNSUITED).' >&2; exit 1; }
@$(BIN)/python -m pip --version >/dev/null 2>&1 || $(PYTHON) -m venv --clear $(VENV)
endef
# What is installed: enough to measure, the window as well, or all that tests and tools want.
CORE   := $(VENV)/.core
WINDOW := $(VENV)/.window
READY  := $(VENV)/.ready
OUT    ?= out

# Tests at a time, each on one core, for two cores. A third of their time and more they wait: for the disk, a window, a
# camera, another process. Proofs compute. Each takes up to 2 GB with the processes of its windows.
TESTS_AT_ONCE  ?= 3
PROOFS_AT_ONCE ?= 2
# A test process that crashes ends the run at once: with these scopes a new one would wait for work for ever.
# Where they are handed out, modules are so in the order tests/conftest.py puts them into: long ones first, by tests/durations.txt.
AS_MODULES   := --dist loadscope --no-loadscope-reorder --max-worker-restart=0
SIDE_BY_SIDE := -n $(TESTS_AT_ONCE) $(AS_MODULES)

# On a virtual screen, with the real 3D view: what a technician does there. Most of it is tested there only, if there
# is one; the 3D view is also tested without a screen, where 3D is a picture. These tests often wait for a camera, so one
# process of them runs beside those of the others.
BOTH_WAYS   := $(filter-out %_numbers.py,$(wildcard tests/workbench/views/scene/test_*.py))
SCREEN_ONLY := $(wildcard tests/workbench/test_behaviour_*.py tests/workbench/test_whole_job*.py)
ON_SCREEN   := -n 1 $(AS_MODULES)
VIRTUAL_SCREEN := $(shell command -v Xvfb)

# What runs beside the tests offscreen is told when it ends.
IN_ONE_PIECE = > "$$TRISECT_MADE_ONCE/$@" 2>&1; passed=$$?; cat "$$TRISECT_MADE_ONCE/$@"; exit $$passed

# Files with proofs: to import all the others takes each process as long as a proof. Those of SCREEN_ONLY are proven
# where they are tested.
PROOFS           = $(shell grep -rl --include='test_*.py' 'mark\.accuracy' tests | sort)
PROOFS_ON_SCREEN = $(filter $(SCREEN_ONLY),$(PROOFS))
# $(call prove,SURROUNDINGS,FILES): pytest would take no file for all of them.
prove = $(if $(strip $(2)),(set -x; $(1) $(BIN)/pytest -p tests.time_left -p tests.passed_proofs -rs -n $(PROOFS_AT_ONCE) $(AS_MODULES) -m accuracy $(2)),true)

# Compiled modules are kept, whatever the surroundings say: each of some hundreds of processes of a test run would
# compile half a million lines anew.
unexport PYTHONDONTWRITEBYTECODE

SCREEN := $(shell command -v xvfb-run >/dev/null && echo 'xvfb-run -a -s "-screen 0 1920x1080x24"')

.PHONY: demo app test beside below_workbench touched_below_workbench imports on_screen examples quick proofs touched_proofs proven accuracy bench soak fuzz check docs translations messages structure notice screenshots pictures wheel compile lock bundle try-bundle clean

demo: $(CORE)             ## measure the embedded sample: cloud, mesh and report of a 50 mm gauge block in ./out
	$(BIN)/trisect demo --out $(OUT)

app: $(WINDOW)            ## open the workbench
	$(BIN)/trisect-workbench

compile: $(READY)         ## once, so that test processes do not all compile the same at the same time
	$(BIN)/python -c 'from core.pipeline.compile_ahead import compile_ahead; compile_ahead()'

test: $(READY)            ## format, lint, types, rooms, examples, every test; windows offscreen and on a virtual screen
	@TRISECT_MADE_ONCE=$$(mktemp -d) && export TRISECT_MADE_ONCE && trap 'rm -rf "$$TRISECT_MADE_ONCE"' EXIT && trap 'exit 130' INT TERM; \
	$(if $(VIRTUAL_SCREEN),,echo "Xvfb is not installed: windows are tested without a screen only";) \
	$(MAKE) --no-print-directory -j$(words beside on_screen $(PARTS)) beside $(if $(VIRTUAL_SCREEN),on_screen) $(PARTS)

# Each process imports the modules of its own part only, by tests/durations.txt; the first one tells as it goes.
PARTS := $(addprefix offscreen_,$(shell seq $(TESTS_AT_ONCE)))
$(PARTS): offscreen_%: compile
	@( set -x; QT_QPA_PLATFORM=offscreen $(BIN)/pytest --part $*/$(TESTS_AT_ONCE) $(if $(VIRTUAL_SCREEN),$(SCREEN_ONLY:%=--ignore=%)) ) \
	$(if $(filter 1,$*),,$(IN_ONE_PIECE))

# What is checked without tests: each of it keeps one core busy, so it fills the time in which tests wait. They have to
# be in time in what they do by the clock, so they come first.
beside: compile
	@{ nice $(MAKE) --no-print-directory check && nice $(MAKE) --no-print-directory examples; } $(IN_ONE_PIECE)

# Files of tests; pytest would take no file for all.
BELOW_WORKBENCH = --ignore=tests/workbench
below_workbench: compile  ## every test but those of windows: what another Python than that of `make test` has to pass
	@# 5: there are only proofs in these files
	$(if $(strip $(BELOW_WORKBENCH)),QT_QPA_PLATFORM=offscreen $(BIN)/pytest -p tests.time_left $(SIDE_BY_SIDE) $(BELOW_WORKBENCH) || [ $$? -eq 5 ])

touched_below_workbench: imports ## every module imported; the tests nearest to what has changed since all passed there (.ci/proven)
	@touched=$$($(BIN)/python -m tests.changed second) && $(MAKE) --no-print-directory below_workbench BELOW_WORKBENCH="$$touched"

imports: $(READY)         ## import every module of the program
	QT_QPA_PLATFORM=offscreen $(BIN)/python -m tests.imports

on_screen: compile
	@( set -x; TRISECT_VIRTUAL_SCREEN=1 $(BIN)/pytest $(ON_SCREEN) $(BOTH_WAYS) $(SCREEN_ONLY) ) $(IN_ONE_PIECE)

examples: compile         ## those in the code's documentation and in the manual
	$(BIN)/pytest -q -p tests.examples --doctest-modules --doctest-glob='*.md' core trisect resources/manual

quick: check              ## the same without what is slow
	QT_QPA_PLATFORM=offscreen $(BIN)/pytest $(SIDE_BY_SIDE) -m "not slow and not accuracy"

proofs: $(READY)          ## what many measurements must keep, and whole jobs in all their forms: the short form of `make accuracy`
	@if command -v Xvfb >/dev/null; then \
	$(call prove,QT_QPA_PLATFORM=offscreen,$(filter-out $(SCREEN_ONLY),$(PROOFS))) && \
	$(call prove,TRISECT_VIRTUAL_SCREEN=1,$(PROOFS_ON_SCREEN)); \
	else echo "Xvfb is not installed: windows are proven without a screen only"; \
	$(call prove,QT_QPA_PLATFORM=offscreen,$(PROOFS)); fi

touched_proofs: $(READY)  ## those that rest on something that has changed since they passed (.ci/proven); the others are listed
	@touched=$$($(BIN)/python -m tests.changed proofs) && $(MAKE) --no-print-directory proofs PROOFS="$$touched"

proven: $(READY)          ## into .ci/proven: the files of proofs that have passed whole here, by `make proofs` on a tree without changes
	$(BIN)/python -m tests.changed passed

accuracy: proofs          ## measure the manual's accuracy tables anew, ideal and hostile: hours; goes on where it was cut off
	$(BIN)/python -m tests.accuracy --manual
	$(BIN)/python -m tests.accuracy hostile
	$(BIN)/python -m tests.accuracy ideal

soak: $(READY)            ## ten minutes of an emulated camera at full size through the live scan page; every state of a folder of results; 100 kills each of all that writes
	$(BIN)/python -m tests.soak --window --seconds 600
	$(BIN)/python -m tests.output_states
	$(BIN)/python -m tests.soak_kills --kills 100

fuzz: $(READY)            ## 100,000 files of strangers, each time others: no trace, no crash, no wait; an hour or so
	$(BIN)/python -m tests.hostile

bench: $(READY)           ## how fast it is, as ratios to OpenCV and scikit-image within one run: a few minutes
	$(BIN)/pytest -q tests/benchmarks/bench_*.py --benchmark-timer=time.process_time --benchmark-columns=min,median,rounds

screenshots: $(READY)     ## pictures of every page, four sizes, both themes, in ./screenshots; twice as fine by QT_SCALE_FACTOR=2
	$(SCREEN) $(BIN)/python -m tests.workbench.screenshots screenshots

pictures: $(READY)        ## the pictures of README and manual
	$(SCREEN) $(BIN)/python -m tests.workbench.screenshots resources/pictures --readme

# LANGUAGE counts on the command line alone: in the surroundings it is the reader's own, gettext's list.
translations: $(READY)    ## every text of the code into the catalogues of all languages, resources/translations/*.po; LANGUAGE=fr adds one
	$(BIN)/python -m tests.translations$(if $(findstring command,$(origin LANGUAGE)), $(LANGUAGE))

messages: $(READY)        ## the manual's page of every error and warning by code, resources/manual/messages.md
	$(BIN)/python -m tests.message_page

structure: $(READY)       ## before and after of the rooms, in the manual's page on architecture
	$(BIN)/python -m tests.structure

notice: $(READY)          ## NOTICE: what the program stands on, and under which licences
	$(BIN)/python -m tests.licences

check: $(READY)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/pytest -q -n 0 tests/test_licences.py

docs: $(READY)            ## the manual as pages for a browser, in build/manual; dead links are errors
	$(BIN)/sphinx-build -n -W --keep-going -q -b html resources/manual build/manual

# A measurement in an empty environment $(1) with the wheel $(2), and the machine code that it had to make in `cache`.
TRY = $(BIN)/python -m venv build/wheel/$(1) && \
	build/wheel/$(1)/bin/pip install --quiet --disable-pip-version-check --constraint constraints.txt build/wheel/$(2) && \
	cd build/wheel/$(1) && NUMBA_CACHE_DIR=cache bin/trisect demo --quick --out demo

wheel: compile            ## build two wheels and try each in an empty environment: a plain one, and one for this system and Python that compiles nothing
	rm -rf build/wheel
	$(BIN)/trisect demo --quick --out build/wheel/first
	$(BIN)/python -m build --wheel --outdir build/wheel .
	TRISECT_SAVED_CODE="$$($(BIN)/python -c 'from core.compiled import FOLDER; print(FOLDER)')" $(BIN)/python -m build --wheel --outdir build/wheel .
	$(call TRY,tagged,trisect-*-cp3*.whl)
	test -z "$$(find build/wheel/tagged/cache -type f)"
	$(call TRY,plain,trisect-*-py3-none-any.whl)
	test -n "$$(find build/wheel/plain/cache -type f)"

# What locks and bundles are made with has an environment of its own: none of it is part of the program.
TOOLS   := build/tools/.ready
BUNDLE  := build/bundle
FROZEN  := $(BUNDLE)/venv/.ready
HASHED  := install --quiet --disable-pip-version-check --require-hashes --requirement
COMPILE := build/lock/bin/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
	--no-annotate --no-header $(if $(UPGRADE),--upgrade)

lock:                     ## versions and hashes of all that is installed, for every system; UPGRADE=1 takes newer ones
	$(PYTHON) -m venv build/lock
	build/lock/bin/pip install --quiet --disable-pip-version-check uv
	$(COMPILE) --all-extras pyproject.toml --output-file locks/dev.txt
	$(COMPILE) $(EXTRAS:%=--extra %) --group bundle --constraint locks/dev.txt pyproject.toml --output-file locks/bundle.txt
	$(COMPILE) --group tools --constraint locks/dev.txt --output-file locks/tools.txt
	@# pip takes no folder, so not this one, where a constraint has a hash
	{ echo '# Versions this was tested with; pip install -c constraints.txt. Written by `make lock`; with hashes: locks/'; \
	sed -n 's/ *\\$$//; /==/p' locks/dev.txt; } > constraints.txt

EXTRAS = $(shell sed -n 's/^EXTRAS = //p' bundle/contents.py | tr -d '(),"')

bundle: $(FROZEN) $(TOOLS) ## the program as one folder to double-click, .tar.xz and .deb, in build/bundle: five minutes and 4 GB
	build/tools/venv/bin/cyclonedx-py environment --pyproject pyproject.toml --output-reproducible \
	--output-file $(BUNDLE)/sbom.cdx.json $(BUNDLE)/venv/bin/python
	$(BUNDLE)/venv/bin/python bundle/build.py
	cat $(BUNDLE)/sizes.txt && ls -l $(BUNDLE)/trisect*

try-bundle:               ## try the .deb in a bare Debian 13 without Python, with a window: needs root, debootstrap and `make bundle`
	bundle/try_out.sh $(BUNDLE)

$(TOOLS): locks/tools.txt
	$(PYTHON) -m venv build/tools/venv
	build/tools/venv/bin/pip $(HASHED) locks/tools.txt
	touch $@

$(FROZEN): pyproject.toml locks/bundle.txt $(TOOLS)
	rm -rf $(BUNDLE)/venv && $(PYTHON) -m venv $(BUNDLE)/venv
	$(BUNDLE)/venv/bin/pip $(HASHED) locks/bundle.txt
	PYTHONPATH=$$(echo build/tools/venv/lib/python3*/site-packages) \
	$(BUNDLE)/venv/bin/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	touch $@

$(CORE): pyproject.toml constraints.txt
	$(ENVIRONMENT)
	$(PIP) --editable .
	touch $@

$(WINDOW): pyproject.toml constraints.txt
	$(ENVIRONMENT)
	$(PIP) --editable '.[window]'
	touch $(CORE) $@

$(READY): pyproject.toml constraints.txt
	$(ENVIRONMENT)
	$(PIP) --editable '.[dev]'
	touch $(CORE) $(WINDOW) $@

clean:
	rm -rf $(VENV) build dist $(OUT) screenshots
