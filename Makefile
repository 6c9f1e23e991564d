# Each target first makes what it needs.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
LOTS_FOLDER := build/lots
OUTSIDE := tests/plc/npm
PIP := $(BIN)/python -m pip --disable-pip-version-check install --quiet -c constraints.txt

.PHONY: help setup demo test lint bench chaos-plc chaos-covers chaos-records chaos-panel soak-panel
.PHONY: networks screenshots translations docs registers bundle clean

help: ## list the targets
	@grep -E '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 12

setup: $(VENV)/.dev ## install everything into .venv

demo: $(VENV)/.demo ## run the station against a simulated line with 24 parts
	$(BIN)/weldgate-demo

test: lint ## check style, types and import contracts, run all tests and list the slowest
	$(BIN)/python -m pytest -n 2 --dist loadfile --durations=25

lint: $(VENV)/.dev ## check style (ruff), types (mypy) and import contracts
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(VENV)/.dev ## measure the times of the station, the finder, the PLC link, records, generator and classifier
	$(BIN)/python -m deploy.bench.station
	$(BIN)/python -m deploy.bench.finder
	$(BIN)/python -m deploy.bench.plc
	$(BIN)/python -m deploy.bench.plc_part
	$(BIN)/python -m deploy.bench.records
	$(BIN)/python -m deploy.bench.render
	$(BIN)/python -m deploy.bench.classifier

chaos-plc: $(VENV)/.demo ## pass 10,000 parts in each PLC mode while both sides misbehave
	$(BIN)/python -m deploy.chaos.plc
	$(BIN)/python -m deploy.chaos.plc --parts 1000 --poll-ms 100 --timers access

chaos-covers: $(VENV)/.demo ## cover defects of labelled frames in twelve ways: LOTS="folder ..."
	$(BIN)/python -m deploy.chaos.covered $(LOTS)

chaos-records: $(VENV)/.demo ## kill a writer of records 300 times and check the archive
	$(BIN)/python -m deploy.chaos.records

chaos-panel: $(VENV)/.demo ## kill, restart and suspend the window while 600 parts pass
	$(BIN)/python -m deploy.chaos.panel

soak-panel: $(VENV)/.demo ## send eight hours of events to the window in fast motion
	$(BIN)/python -m deploy.chaos.soak_panel

networks: $(VENV)/.dev ## draw the pictures of the ring and the seen network again and train both; can be continued
	$(BIN)/weldgate-synth pictures --use ring --seed 16 --count 1500 --out $(LOTS_FOLDER)/ring-16
	$(BIN)/weldgate-synth pictures --use crops --seed 23 --count 450 --out $(LOTS_FOLDER)/crops-23
	$(BIN)/weldgate-synth pictures --use crops --seed 24 --count 450 --out $(LOTS_FOLDER)/crops-24
	$(BIN)/weldgate-synth pictures --use ring --seed 17 --count 2000 --out $(LOTS_FOLDER)/ring-17
	$(BIN)/weldgate-synth pictures --use plugs --seed 18 --count 1000 --out $(LOTS_FOLDER)/plugs-18
	$(BIN)/weldgate-models train-ring $(LOTS_FOLDER)/ring-16 $(LOTS_FOLDER)/ring-17 $(LOTS_FOLDER)/plugs-18 \
		--steps 20000 --version 0.3.0 --out build/networks
	$(BIN)/weldgate-models train-seen $(LOTS_FOLDER)/crops-23 $(LOTS_FOLDER)/crops-24 --steps 4500 --seed 1 \
		--version 0.3.0 --out build/networks

screenshots: $(VENV)/.dev ## take screenshots of all pages of the window, in all languages and themes
	xvfb-run -a -s "-screen 0 1920x1200x24" $(BIN)/python -m deploy.docs.screenshots

translations: $(VENV)/.dev ## collect the texts of the window in weldgate_de.ts, compile weldgate_de.qm
	$(BIN)/python -m deploy.docs.translations

docs: $(VENV)/.docs ## build the documentation as a site that needs no network, in site/
	$(BIN)/python -m deploy.docs.build

registers: $(VENV)/.demo ## write the register map and the PLC block in all forms to deploy/plc
	$(BIN)/weldgate registers --format md > deploy/plc/register_map.md
	$(BIN)/weldgate registers --format block > deploy/plc/block.md
	$(BIN)/weldgate registers --format plcopen > deploy/plc/weldgate_plcopen.xml
	$(BIN)/weldgate registers --format openplc > deploy/plc/weldgate_openplc.st
	$(BIN)/weldgate registers --format st > deploy/plc/weldgate.st
	$(BIN)/weldgate registers --format scl > deploy/plc/weldgate.scl
	$(BIN)/weldgate registers --format symbols > deploy/plc/weldgate_symbols.csv

bundle: $(VENV)/.demo ## build the offline bundle of the line PC and its Debian package in build/
	$(BIN)/python -m deploy.bundle --deb

clean: ## remove the virtual environment
	rm -rf $(VENV)

$(VENV)/.system: deploy/system.sh
	deploy/system.sh
	$(PYTHON) -m venv $(VENV)
	touch $@

$(VENV)/.demo: $(VENV)/.system pyproject.toml constraints.txt
	$(PIP) -e '.[synth]'
	touch $@

$(VENV)/.dev: $(VENV)/.demo pyproject.toml constraints.txt deploy/system.sh $(OUTSIDE)/package-lock.json
	deploy/system.sh test
	$(PIP) -e '.[synth,train,s7,tls,pdf,docs,dev]'
	PATH="$(CURDIR)/$(BIN):$$PATH" npm ci --prefix $(OUTSIDE) --omit=optional --ignore-scripts --no-audit --no-fund \
		|| echo "the client in JavaScript could not be installed: its test is skipped"
	touch $@

$(VENV)/.docs: $(VENV)/.system pyproject.toml constraints.txt
	$(PIP) -e '.[docs]'
	touch $@
