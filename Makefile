# The front door. `make help` lists the verbs; each is one line into CMake or a script.
BOARD ?= mps2-an386
BOARDS ?= $(BOARD)
JOBS ?= $(shell nproc)
CMAKE_HOST = cmake/bootstrap.sh host && cmake --preset host --log-level=WARNING >/dev/null && cmake --build build/host -j $(JOBS)
PYTHON = PATH="$(CURDIR)/build/bin:$(CURDIR)/build/deps/venv/bin:$$PATH" PYTHONPATH="$(CURDIR)/tools:$(CURDIR)/build/host/lcm/python" build/deps/venv/bin/python
export PYTHONDONTWRITEBYTECODE = 1

all: ## build the desktop programs into build/bin
	@$(CMAKE_HOST) --target programs

demo: all ## simulate a survey flight, run the firmware on it, print its error table
	@PATH="$(CURDIR)/build/bin:$$PATH" bash tools/demo.sh $(ARGS)

test: ## run every test, then the unit tests under sanitizers
	@JOBS=$(JOBS) bash cmake/test.sh

firmware: ## cross-compile for BOARD (mps2-an386, mps2-an500, stm32f405, rv32-virt); print code, RAM, stack
	@JOBS=$(JOBS) bash cmake/firmware.sh $(BOARD)

pil: ## replay captures on emulated BOARD (BOARDS="..." for several), hold the bytes against the desktop's
	@JOBS=$(JOBS) bash cmake/pil.sh $(BOARDS) $(ARGS)

sizes: ## measure code, RAM, stack and instructions on the boards, write docs/SIZES.md (ARGS=--check: hold it against them)
	@cmake/bootstrap.sh host target && $(CMAKE_HOST) --target programs pil_programs && $(PYTHON) -m pil.sizes $(ARGS)

check: ## format, warnings with gcc and clang, clang-tidy, cppcheck, headers, symbols
	@JOBS=$(JOBS) bash cmake/check.sh

bench: all ## instructions per IMU step, row and epoch, beside the budgets
	@cmake/bootstrap.sh bench && build/bin/pelorus-bench $(ARGS)

promise: all ## wrong fixes of simulated epochs beside the promised rate: table, docs/img/promise.png
	@$(PYTHON) -m promise $(ARGS)

replay: all ## replay real recordings, one table
	@cmake/bootstrap.sh test && $(CMAKE_HOST) --target peer_integers && PATH="$(CURDIR)/build/host/tests/peers:$$PATH" && $(PYTHON) -m replay $(ARGS)

campaign: all ## the published systems over seeds: paper, bound and ours; writes the tables of docs/ACCURACY.md
	@cmake/bootstrap.sh test && $(PYTHON) -m campaign --docs docs/ACCURACY.md $(ARGS)

faults: all ## every fault on every line in every phase against its table; writes docs/FAULTS.md
	@cmake/bootstrap.sh test && $(PYTHON) tests/scenario/fault_campaign.py --docs docs/FAULTS.md $(ARGS)

survival: all ## 20 000 bit flips over the whole static state, 5 000 more under sanitizers; writes the table in docs/SURVIVAL.md
	@JOBS=$(JOBS) bash cmake/survival.sh $(ARGS)

fuzz: ## run each fuzz target for SECONDS (30)
	@JOBS=$(JOBS) bash cmake/fuzz.sh $(or $(SECONDS),30) $(ARGS)

prove: ## hold the proofs of tests/prove, each against its twin with a planted bug
	@JOBS=$(JOBS) bash cmake/prove.sh $(ARGS)

coverage: ## lines, branches and MC/DC of firmware/ that the tests reach, by room
	@JOBS=$(JOBS) bash cmake/coverage.sh $(ARGS)

format: ## clang-format every C and C++ file
	@git ls-files -co --exclude-standard '*.c' '*.h' '*.cpp' | xargs clang-format -i

asan: ## build everything and run the unit tests under address and undefined-behaviour sanitizers
	@cmake/bootstrap.sh host test && cmake --preset host-asan --log-level=WARNING >/dev/null && cmake --build build/asan -j $(JOBS) && ctest --test-dir build/asan -L unit -j $(JOBS) --output-on-failure

clean: ## remove what was built, keep what was fetched
	@find build -mindepth 1 -maxdepth 1 ! -name deps -exec rm -rf {} + 2>/dev/null; true

help: ## this list
	@sed -n 's/^\([a-z]*\):.*## /  make \1\t/p' $(MAKEFILE_LIST) | expand -t 20

.PHONY: all demo test firmware pil sizes check bench promise replay campaign faults survival fuzz prove coverage format asan clean help
