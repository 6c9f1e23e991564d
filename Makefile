# Each target makes what it needs first.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check install --quiet -c constraints.txt

.PHONY: help setup demo test lint bench chaos-plc chaos-records chaos-panel soak-panel screenshots translations docs registers clean

help: ## what can be made
	@grep -E '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 12

setup: $(VENV)/.dev ## everything, into .venv

demo: $(VENV)/.demo ## the station against a simulated line, 24 parts
	$(BIN)/weldgate-demo

test: lint ## linters, types, import contracts, tests; names the slowest
	$(BIN)/python -m pytest -n 2 --dist loadfile --durations=25

lint: $(VENV)/.dev ## ruff, mypy, import contracts
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(VENV)/.dev ## times of each step on the emulated camera, of the generator and of the classifier
	$(BIN)/python -m deploy.bench.station
	$(BIN)/python -m deploy.bench.plc
	$(BIN)/python -m deploy.bench.records
	$(BIN)/python -m deploy.bench.render
	$(BIN)/python -m models.bench

chaos-plc: $(VENV)/.demo ## 10,000 parts in each PLC mode with both sides misbehaving
	$(BIN)/python -m deploy.chaos.plc

chaos-records: $(VENV)/.demo ## 300 kills of a writer of records
	$(BIN)/python -m deploy.chaos.records

chaos-panel: $(VENV)/.demo ## the window killed, restarted and stopped while 600 parts pass
	$(BIN)/python -m deploy.chaos.panel

soak-panel: $(VENV)/.demo ## eight hours of events through the window in fast motion
	$(BIN)/python -m deploy.chaos.soak_panel

screenshots: $(VENV)/.dev ## every page of the window in both languages and themes, into screenshots/
	xvfb-run -a -s "-screen 0 1920x1200x24" $(BIN)/python -m deploy.docs.screenshots

translations: $(VENV)/.dev ## texts of the window into weldgate_de.ts, that into weldgate_de.qm
	$(BIN)/python -m deploy.docs.translations

docs: $(VENV)/.docs ## the pages of deploy/docs, a drawing of the rooms and the API as a site that needs no network, into site/
	$(BIN)/python -m deploy.docs.build

registers: $(VENV)/.demo ## the register map and the PLC block in all four forms, into deploy/plc
	$(BIN)/weldgate registers --format md > deploy/plc/register_map.md
	$(BIN)/weldgate registers --format st > deploy/plc/weldgate.st
	$(BIN)/weldgate registers --format scl > deploy/plc/weldgate.scl
	$(BIN)/weldgate registers --format symbols > deploy/plc/weldgate_symbols.csv

clean: ## remove the virtual environment
	rm -rf $(VENV)

$(VENV)/.system: deploy/system.sh
	deploy/system.sh
	$(PYTHON) -m venv $(VENV)
	touch $@

$(VENV)/.demo: $(VENV)/.system pyproject.toml constraints.txt
	$(PIP) -e '.[synth]'
	touch $@

$(VENV)/.dev: $(VENV)/.demo pyproject.toml constraints.txt deploy/system.sh
	deploy/system.sh test
	$(PIP) -e '.[synth,train,tls,pdf,docs,dev]'
	touch $@

$(VENV)/.docs: $(VENV)/.system pyproject.toml constraints.txt
	$(PIP) -e '.[docs]'
	touch $@
