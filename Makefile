# Two commands: `make demo` and `make test`. Both install what they need into .venv.
PYTHON ?= python3
BIN := .venv/bin

.PHONY: demo test lint bench bench-closed-forms bench-codegen bench-rollouts clean

demo: .venv/installed
	$(BIN)/mcgee explain planar_2r --q 0.5,0.3 --qd 0.1,-0.2 --html planar_2r.html
	$(BIN)/mcgee explain src/mcgee/robots/panda.urdf --q 0,-0.8,0,-2.4,0,1.6,0.8 \
	  --qd 0.5,0,0,0.5,0,0,1 --html panda.html

test: .venv/installed-test
	$(BIN)/python -m pytest -n auto --dist loadfile

lint: .venv/installed-test
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .
	$(BIN)/mypy

bench: .venv/installed-test
	env -u OPENBLAS_CORETYPE -u OPENBLAS_L2_SIZE $(BIN)/python benchmarks/compare.py --chains

bench-closed-forms: .venv/installed-test
	$(BIN)/python benchmarks/closed_forms.py

bench-codegen: .venv/installed-test
	env -u OPENBLAS_CORETYPE -u OPENBLAS_L2_SIZE $(BIN)/python benchmarks/codegen.py

bench-rollouts: .venv/installed-test
	env -u OPENBLAS_CORETYPE -u OPENBLAS_L2_SIZE $(BIN)/python benchmarks/rollouts.py

.venv/installed: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and \
	  "mcgee needs Python 3.11 or newer, this is %s; say make PYTHON=python3.x" % sys.version.split()[0])'
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[plot]'
	@touch $@

.venv/installed-test: .venv/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[plot,test]'
	@touch $@

clean:
	rm -rf .venv .pytest_cache .mypy_cache .ruff_cache .hypothesis
