PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready

DEMO ?= runs/demo-$(shell date +%Y%m%d-%H%M%S)

.PHONY: setup demo test test-all check messages docs clean

setup: $(READY)

# A simulated swarm from end to end: a run directory with the log, the learning curve, a summary.
demo: setup
	$(BIN)/swarm simulate deploy/sim/demo.toml --out $(DEMO)
	$(BIN)/swarm analyze $(DEMO)

$(READY): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]'
	touch $@

check: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

test: setup check
	$(BIN)/pytest -m "not long"

test-all: setup check
	$(BIN)/pytest

clean:
	rm -rf $(VENV) build dist *.egg-info

messages: setup
	$(BIN)/python -m grpc_tools.protoc -I . --python_out=. --mypy_out=. swarm/messages/swarm.proto

# The parts of the documentation that are made from the code; tests compare them.
docs: setup
	$(BIN)/python -m swarm.messages.topic_reference > docs/keys.md
