PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready

.PHONY: setup demo test test-all check messages clean

setup: $(READY)

$(READY): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]'
	touch $@

check: setup
	$(BIN)/ruff check .
	$(BIN)/mypy

test: setup check
	$(BIN)/pytest -m "not long"

test-all: setup check
	$(BIN)/pytest

clean:
	rm -rf $(VENV) build dist *.egg-info

messages: setup
	$(BIN)/python -m grpc_tools.protoc -I . --python_out=. --mypy_out=. swarm/messages/swarm.proto
