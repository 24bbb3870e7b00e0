PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready

# Most tests wait for processes that they started: four at a time keep two cores busy. A file is one worker's.
WORKERS ?= -n 4 --dist loadfile

DEMO ?= runs/demo-$(shell date +%Y%m%d-%H%M%S)

.PHONY: setup demo test test-faults test-all check format coverage site messages docs wheel clean

setup: $(READY)

# A simulated swarm from end to end: a run directory with the log, the learning curve, a summary.
demo: setup
	$(BIN)/swarm simulate deploy/sim/demo.toml --out $(DEMO)
	$(BIN)/swarm analyze $(DEMO)

$(READY): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed, and $(PYTHON) is %d.%d: make PYTHON=python3.11" % sys.version_info[:2])'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]'
	touch $@

check: setup site
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: setup
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

test: setup check
	$(BIN)/pytest $(WORKERS) -m "not long and not faults"

# Everything that is injected from outside: signals at every instant, settings at the ends of their ranges.
test-faults: setup
	$(BIN)/pytest -m faults

test-all: setup check
	$(BIN)/pytest

# The tests of `make test`, with the processes that they start; fails below the floor in pyproject.toml.
coverage: setup
	$(BIN)/coverage erase
	$(BIN)/coverage run -m pytest -m "not long and not faults"
	$(BIN)/coverage combine --quiet
	$(BIN)/coverage report

# The documentation as a website, in site/: a broken link or a page that nothing leads to is an error.
site: setup
	$(BIN)/sphinx-build --quiet --fresh-env --nitpicky --fail-on-warning -d build/doctrees docs site

# The wheel, checked as a user would meet it: installed in an empty environment outside the checkout.
wheel:
	rm -rf dist build/tools build/empty
	$(PYTHON) -m venv build/tools
	build/tools/bin/pip install --quiet --disable-pip-version-check build==1.6.1 twine==7.0.0
	build/tools/bin/python -m build
	build/tools/bin/twine check --strict dist/*
	$(PYTHON) -m venv build/empty
	build/empty/bin/pip install --quiet --disable-pip-version-check -c constraints.txt "$$(ls dist/*.whl)[lab]"
	cd build/empty && bin/swarm --version && bin/swarm --help && bin/robot-agent --help

clean:
	rm -rf $(VENV) build dist site *.egg-info

messages: setup
	$(BIN)/python -m grpc_tools.protoc -I . --python_out=. --mypy_out=. swarm/messages/swarm.proto

# The parts of the documentation that are made from the code; tests compare them.
docs: setup
	$(BIN)/python -m swarm.messages.topic_reference > docs/keys.md
	$(BIN)/python -m swarm.analysis.table_reference > docs/tables.md
