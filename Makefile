# The front door. What is built, and how, stands in CMakeLists.txt; the packages stand in .ci/packages.
.DEFAULT_GOAL := help
.PHONY: help deps deps-build deps-test deps-bench deps-boards deps-web deps-format deps-coverage all run sim install install-python \
  uninstall deb packages release sanitize clang fuzz check test test-all coverage bench firmware emulate images flash test-boards test-packages \
  bench-frames test-framebuffer test-threads mutants ranges soak web test-web bench-web format tidy clean

CONFIGURE = cmake -S . -G Ninja --log-level=WARNING -Wno-dev
# Everything that is ours and formatted by clang-format.
FORMATTED = find include src platform tools tests \( -name '*.h' -o -name '*.cpp' \) -print

help: ## Say what there is
	@sed -n 's/^\([a-z-]*\):.*## /make \1\t/p' $(MAKEFILE_LIST) | awk -F'\t' '{ printf "  %-22s %s\n", $$1, $$2 }'

deps: ## Install what building, testing and measuring need (apt-get; as root or by sudo)
	@.ci/deps build tools test boards bench
deps-build:
	@.ci/deps build tools
deps-test:
	@.ci/deps build tools test python
deps-bench:
	@.ci/deps build tools bench
deps-boards:
	@.ci/deps build tools boards
deps-web:
	@.ci/deps build web
deps-format:
	@.ci/deps format
deps-coverage:
	@.ci/deps coverage

# Only a fresh folder is configured without the tests: CMake removes the objects of what is switched off.
LEAN = $(if $(wildcard build/release/build.ninja),,-DTHIMBLE_TESTS=OFF -DTHIMBLE_GOLDEN=OFF)
all: deps-build ## Build the library and the thimble command (build/release)
	@$(CONFIGURE) -B build/release $(LEAN) >/dev/null
	@.ci/build "build/release" build/release src/all platform/all tools/all
run: all ## Render four scenes within fixed budgets into out/ and print what they took
	@sh tools/run_demo.sh build/release/thimble out
sim: all ## Run the demo as on BOARD=NAME, in a window or the terminal (SCENE=..., SIM_ARGS=...)
	@build/release/thimble sim $(filter-out auto,$(SCENE)) --board $(BOARD) $(SIM_ARGS)

# DESTDIR is another root, for packages. An empty PREFIX is the root itself.
PREFIX ?= /usr/local
DESTDIR ?=
INSTALL = cmake --install build/release --prefix "$(or $(PREFIX),/)" --strip >/dev/null
install: all ## Install command, library, scenes, manual, completions (PREFIX=/usr/local, DESTDIR=...)
	@DESTDIR="$(DESTDIR)" $(INSTALL)
	@echo "installed in $(DESTDIR)$(or $(PREFIX),/)"
PYTHON ?= $(or $(wildcard /usr/bin/python3),python3)
# What is compiled for the command is linked once more as the module.
PYTHON_MODULE = $(CONFIGURE) -B build/release -DTHIMBLE_PYTHON=ON -DPython3_EXECUTABLE=$(shell command -v $(PYTHON)) $(LEAN) \
  >/dev/null && .ci/build "the module for Python" build/release thimble_python && mkdir -p build/packages && \
  $(PYTHON) -B tools/packages/make.py python
PIP = THIMBLE_BUILD="$(CURDIR)/build/release" $(PYTHON) -m pip --quiet --disable-pip-version-check
PIP_OFFLINE = --no-index --no-build-isolation --no-deps
install-python: all ## Install the Python package (PYTHON=venv/bin/python: into that environment)
	@.ci/deps python
	@$(PYTHON_MODULE)
	@$(PIP) install $(PIP_OFFLINE) --force-reinstall $(PIP_ARGS) build/packages/thimble_voxels-*.tar.gz
uninstall: all ## Remove what `make install` with the same PREFIX and DESTDIR installs
	@sh tools/uninstall.sh build/release "$(DESTDIR)" "$(or $(PREFIX),/)"
deb: all ## Make Debian packages of what `make install` installs (build/release/*.deb)
	@sh tools/package.sh build/release
packages: all ## Make the packages of every ecosystem (build/packages); RELEASE=1 refuses to name no place
	@.ci/deps packages
	@mkdir -p build/packages && rm -f build/packages/*
	@$(or $(wildcard /usr/bin/python3),python3) -B tools/packages/make.py $(if $(RELEASE),--release)
	@sh tools/package.sh build/release build/packages
	@.ci/deps python
	@$(PYTHON_MODULE)
	@$(PIP) wheel $(PIP_OFFLINE) --wheel-dir build/packages build/packages/thimble_voxels-*.tar.gz
test-packages: ## Unpack every package in an empty folder and build it by its ecosystem's rules
	@.ci/deps boards
	@$(MAKE) --no-print-directory packages
	@sh tests/packages/run.sh

# What is tested whole is built in four ways; STEP says which of how many steps this is, SANITIZED what is built with
# sanitizers.
TESTED = -DTHIMBLE_TESTS=ON -DTHIMBLE_GOLDEN=ON -DTHIMBLE_PYTHON=ON
SANITIZED ?= all
release:
	@$(CONFIGURE) -B build/release $(TESTED) >/dev/null
	@.ci/build "$(STEP)optimised build" build/release
sanitize:
	@$(CONFIGURE) -B build/sanitize -DTHIMBLE_SANITIZE=ON -DTHIMBLE_GOLDEN=OFF >/dev/null
	@.ci/build "$(STEP)sanitized build" build/sanitize $(SANITIZED)
clang:
	@$(CONFIGURE) -B build/clang -DCMAKE_CXX_COMPILER=clang++ -DTHIMBLE_TOOLS=OFF -DTHIMBLE_TESTS=OFF \
	  -DTHIMBLE_GOLDEN=ON >/dev/null
	@.ci/build "$(STEP)build by clang" build/clang
fuzz:
	@$(CONFIGURE) -B build/fuzz -DCMAKE_CXX_COMPILER=clang++ -DTHIMBLE_TESTS=OFF -DTHIMBLE_FUZZ=ON >/dev/null
	@.ci/build "$(STEP)fuzzers" build/fuzz thimble_fuzzers
# Between edits: no other compiler, no sanitizer, no slow case.
check: deps-test ## Build what is optimised and run its quick tests: one line a group
	@$(CONFIGURE) -B build/release $(TESTED) >/dev/null
	@.ci/build "optimised build" build/release thimble_tests thimble_golden_tests_O2
	@sh tests/check.sh build/release
# Every test once, optimised; what takes minutes (label `whole`) and more cases of a kind are left to test-all.
test: deps-test ## Build and run every test once, optimised, and the quick checks
	@$(CONFIGURE) -B build/release $(TESTED) >/dev/null
	@.ci/build "[1/2] optimised build" build/release src/all platform/all tools/all thimble_tests thimble_golden_tests_O2
	@echo "[2/2] the tests; those that take longest begin"
	@THIMBLE_FEW=all ctest --test-dir build/release --output-on-failure -j 2 -LE whole $(CTEST_ARGS)
# One ctest over all builds, so that there is one summary. AFTER_TEST=yes, where `make test` has just passed: of the
# optimised tests only those that are left to this.
test-all: deps-test ## Build and run everything: optimised, sanitized, clang, fuzzing, mutants, every check
	@$(MAKE) --no-print-directory release STEP='[1/5] '
	@$(MAKE) --no-print-directory sanitize STEP='[2/5] '
	@$(MAKE) --no-print-directory clang STEP='[3/5] '
	@$(MAKE) --no-print-directory fuzz STEP='[4/5] '
	@printf 'subdirs($(if $(AFTER_TEST),,release) sanitize clang fuzz)\n' > build/CTestTestfile.cmake
	@echo "[5/5] the tests; those that take longest begin"
	@status=0; \
	if [ -n "$(AFTER_TEST)" ]; then \
	  ctest --test-dir build/release --output-on-failure -j 2 -L whole $(CTEST_ARGS) || status=1; \
	fi; \
	ctest --test-dir build --output-on-failure -j 2 $(CTEST_ARGS) || status=1; \
	exit $$status

test-threads: deps-test ## Run what draws in several threads under ThreadSanitizer (std::thread in place of oneTBB)
	@$(CONFIGURE) -B build/threads -DTHIMBLE_SANITIZE_THREADS=ON -DTHIMBLE_TESTS=ON -DTHIMBLE_GOLDEN=OFF >/dev/null
	@.ci/build "build for ThreadSanitizer" build/threads thimble_tests
	@build/threads/thimble_tests

# COUNT rays, the first random number SEED.
ranges: deps-test ## Measure how large the core's numbers become, beside what is promised (COUNT=1000000)
	@$(CONFIGURE) -B build/release $(TESTED) >/dev/null
	@.ci/build "the core that measures" build/release thimble_ranges
	@build/release/thimble_ranges $(or $(COUNT),1000000) $(SEED)

soak: deps-test ## Draw by every renderer with hard cameras for MINUTES=, from SEED= on, and say what was wrong
	@$(CONFIGURE) -B build/release $(TESTED) >/dev/null
	@.ci/build "optimised build" build/release thimble_tests
	@THIMBLE_SOAK_MINUTES=$(or $(MINUTES),1) THIMBLE_SOAK_SEED=$(or $(SEED),1) \
	  build/release/thimble_tests --test-case='soak*'

coverage: deps-test deps-coverage ## Count the lines and branches of src that the tests take, by room
	@$(CONFIGURE) -B build/release $(TESTED) -DTHIMBLE_COVERAGE=ON >/dev/null
	@.ci/build "the core that counts" build/release thimble_tests_covered thimble_golden_tests_covered
	@sh tests/coverage.sh build/release

# A sample of every file and kind; results in build/release/mutants/thimble_all_mutants/results.csv.
COUNT ?= 2000
SEED ?= 1
mutants: deps-test ## Change one place of src at a time: which COUNT=2000 of them (SEED=1) does no test notice?
	@$(CONFIGURE) -B build/release $(TESTED) "-DTHIMBLE_MUTANTS=$(COUNT);$(SEED)" >/dev/null
	@.ci/build "the core with mutants" build/release thimble_all_mutants
	@python3 -B tests/mutants/run.py build/release/thimble_all_mutants \
	  build/release/mutants/thimble_all_mutants --check

bench: deps-bench ## Build the benchmarks, and run the table of peers (BENCH_ARGS)
	@$(CONFIGURE) -B build/release -DTHIMBLE_BENCHMARKS=ON $(LEAN) >/dev/null
	@.ci/build "benchmarks" build/release tests/benchmarks/all
	@build/release/thimble_peer_table $(BENCH_ARGS)

# BOARD is a folder of platform/boards, APP a file of platform/apps, SCENE what `thimble bake` takes, EFFECTS its
# --effects.
BOARD ?= lm3s6965evb
APP ?= demo
SCENE ?= auto
export FRAMES EFFECTS BAKE SHOT CRC PLACE
firmware: deps-boards ## Build an image for BOARD=NAME|all, of APP=demo with SCENE=... (build/firmware/NAME)
	@if [ -n "$(SCENE)" ]; then $(MAKE) --no-print-directory all; fi
	@sh platform/build.sh "$(BOARD)" "$(APP)" "$(SCENE)"
emulate: export HOLD = $(if $(SHOT),$(if $(FRAMES),true,false),false)
emulate: firmware ## Run that image under QEMU: the UART on this terminal, the exit status passed on
	@sh platform/emulate.sh "$(BOARD)" "$(APP)" $(QEMU_ARGS)
# All boards, unless one is named.
images: deps-boards all ## Build the programs that `thimble image` puts scenes behind (build/images), of BOARD=NAME or all boards
	@sh platform/images.sh $(if $(filter file,$(origin BOARD)),,$(filter-out all,$(BOARD)))
# Where one of those is there no compiler is needed, but for what a program is built with.
IMAGE = $(if $(filter %.h,$(SCENE))$(FRAMES)$(PLACE),,$(wildcard build/images/$(BOARD)-$(APP)-*.elf.gz))
flash: $(if $(IMAGE),all,firmware) ## Write that image to a real board
	@$(if $(IMAGE),IMAGE=yes )sh platform/flash.sh "$(BOARD)" "$(APP)" "$(SCENE)"
test-boards: ## Run the tests of the firmware on every board under QEMU; says first what it installs
	@sh tests/boards/deps.sh
	@$(MAKE) --no-print-directory all
	@sh tests/boards/run.sh

bench-frames: ## Count the instructions of frames of every size on Cortex-M0 to M7 (WRITE=--write: the table)
	@sh tests/boards/deps.sh
	@$(MAKE) --no-print-directory all
	@sh tests/boards/bench_frames.sh $(WRITE)

test-framebuffer: ## Run thimble-fb on a real /dev/fb0 in an emulated PC; says first what it downloads
	@.ci/deps build tools framebuffer
	@$(MAKE) --no-print-directory all
	@$(CONFIGURE) -B build/static -DTHIMBLE_TESTS=OFF -DTHIMBLE_GOLDEN=OFF -DCMAKE_EXE_LINKER_FLAGS=-static \
	  >/dev/null
	@.ci/build "static build" build/static thimble_framebuffer
	@mkdir -p build/framebuffer && build/release/thimble bake demo -o build/framebuffer/demo.oct --quiet
	@sh tests/linux/framebuffer.sh . build/framebuffer build/static/thimble-fb build/framebuffer/demo.oct

web: deps-web ## Make the page: one file that works from the disk and offline (build/web/thimble.html)
	@sh platform/web/build.sh
# BUILT=yes: of what was built.
test-web: $(if $(BUILT),,web all) ## Test the page in headless Chromium (`make test-all` tests its modules under Node)
	@sh tests/web/run.sh
bench-web: web ## Time frames in headless Chromium
	@node tests/web/bench.js

format: deps-format ## Format every source with clang-format
	@$(FORMATTED) | xargs clang-format -i
# What is linted; `make test-all` lints the core (src) too.
TIDY_FOLDERS ?= src tools platform tests/reference
tidy: deps-test ## Lint the core, the tools and the ports with clang-tidy
	@sh tests/checks/tidy.sh . build/tidy $(TIDY_FOLDERS)
	@sh tests/boards/tidy.sh build/tidy-boards

clean: ## Remove everything that was built
	@rm -rf build out
