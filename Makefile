# Everything a fresh machine needs: `make demo` and `make test`. Python 3.11 or newer is all they ask for.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready
OUT    ?= out

# Two tests at a time, each on one core: linear algebra on more threads than cores is many times slower.
SIDE_BY_SIDE := -n 2 --dist loadscope
test quick: export OPENBLAS_NUM_THREADS = 1
test quick: export OMP_NUM_THREADS = 1

.PHONY: demo test quick check wheel clean

demo: $(READY)            ## measure the embedded sample: cloud, mesh and report of a 50 mm gauge block in ./out
	$(BIN)/trisect demo --out $(OUT)

test: check               ## format, lint, types, rooms, and every test
	$(BIN)/pytest $(SIDE_BY_SIDE)

quick: check              ## the same without the slow proofs
	$(BIN)/pytest $(SIDE_BY_SIDE) -m "not slow"

check: $(READY)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

wheel: $(READY)           ## build the wheel and try it in an empty environment
	rm -rf build/wheel && mkdir -p build/wheel
	$(BIN)/python -m build --wheel --outdir build/wheel .
	$(PYTHON) -m venv build/wheel/venv
	build/wheel/venv/bin/pip install --quiet --constraint constraints.txt build/wheel/trisect-*.whl
	cd build/wheel && venv/bin/trisect demo --quick --out demo

$(READY): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --constraint constraints.txt --editable '.[dev]'
	touch $(READY)

clean:
	rm -rf $(VENV) build dist $(OUT)
