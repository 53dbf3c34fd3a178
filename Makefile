# hifdm: one library, one program. `make help` lists the targets; everything made goes under build/.
#
# The targets people type (all, run, test, ...) only install what is missing and then call this Makefile again for the
# files themselves. Packages therefore exist before pkg-config is asked about them, and builds use every core.

# ---- The rooms: src/ROOM/*.c; src/ARCHITECTURE.md has what each may include (`make lint` checks it) ------------------
LIB_ROOMS := base linalg net truss surface solve search built case store run
APP_ROOMS := out app

# ---- What may be set on the command line -----------------------------------------------------------------------------
VERSION := 0.3.0
SOVERSION := 1
BUILD ?= build
PREFIX ?= /usr/local
# Folder of the libraries below PREFIX; Debian's is lib/x86_64-linux-gnu.
LIB ?= lib
DESTDIR ?=
CFLAGS ?= -O3 -g
LDFLAGS ?=
# With `make WERROR=` a compiler newer than ours, which may have other warnings, can still build it.
WERROR ?= -Werror
# Sanitizers, such as address,undefined or thread; see asan and tsan below.
SANITIZE ?=
# Names or paths under which the program looks for LAPACK when it first needs it. It uses the first one that loads.
LAPACK ?= liblapack.so.3 libopenblas.so.0
# For tests in Python: Debian's own Python, because its packages (h5py, yaml) are for this one.
PYTHON ?= /usr/bin/python3
CASE ?= configs/chen2022.yaml
RESULT ?= results/$(basename $(notdir $(CASE))).h5
TSAN_CASE ?= $(CASE)
TSAN_ARGS ?= --set optimize.generations=5
# Runs only the suites whose ROOM/NAME contains one of these words: `make test SUITE="unit verify/band"`.
SUITE ?=
# Calls that tests/support.c counts and can make fail. Each needs a __wrap_ function there.
TEST_WRAP := malloc calloc realloc aligned_alloc strdup strndup
TEST_WRAP_EXTRA ?=
# Calls that tests/calls.c can make fail.
TEST_WRAP += open close write writev pwrite read pread fsync fdatasync rename link unlink ftruncate lseek flock fcntl \
             fstat stat access H5Fcreate H5Fopen H5Dcreate2 H5Dopen2 H5Dset_extent H5Dwrite H5Dread H5Awrite H5Aread
# tests/guards.c puts guards behind the arrays of arenas.
TEST_WRAP += hf_arena_take hf_arena_allocate hf_arena_free
# A call that tests/unit/base/test_file_out.c replaces.
TEST_WRAP += geteuid

# ---- Flags -----------------------------------------------------------------------------------------------------------
# There is no -ffast-math, and multiply-adds are fused only by fma(). Our code therefore gives the same bits on every
# machine (LAPACK and GSL may not). One set of position-independent objects serves both libraries;
# -fno-semantic-interposition lets them be inlined like others. The shared library exports what the public headers
# declare.
LANGUAGE := -std=c11 -D_POSIX_C_SOURCE=200809L -D_XOPEN_SOURCE=700 -fopenmp
CODEGEN := -fno-math-errno -ffp-contract=off -fPIC -fno-semantic-interposition -fvisibility=hidden
# psabi: functions that take vectors are inlined.
WARNINGS := -Wall -Wextra -Wshadow -Wconversion -Wstrict-prototypes -Wmissing-prototypes -Wvla -Wno-psabi $(WERROR)
# Only for src: every command must run on a stack of 128 kB (tests/cli/test_stack.c). Sanitizers make frames larger.
FRAME := $(if $(SANITIZE),,-Wframe-larger-than=16384)
SANITIZER := $(if $(SANITIZE),-fsanitize=$(SANITIZE) -fno-sanitize-recover=all -fno-omit-frame-pointer)

# pkg-config is asked once, when a recipe first needs it. $(eval) replaces the question by its answer.
PKG = $(eval PKG := $(or $(shell pkg-config --cflags --libs gsl hdf5 zlib yaml-0.1),$(PKG_MISSING)))$(PKG)
PKG_MISSING = $(error A library or pkg-config itself is missing, see above: run `make setup`)
CHECK = $(eval CHECK := $(or $(shell pkg-config --cflags --libs check),$(error run `make test`)))$(CHECK)
# -isystem: our warnings are for our code, not for the headers of HDF5.
PKG_CFLAGS = $(patsubst -I%,-isystem %,$(filter -I% -D%,$(PKG)))
# -ldl: before glibc 2.34 dlopen was not in libc.
PKG_LIBS = $(filter-out -I% -D%,$(PKG)) -ldl -lm

# A peer of the benchmark, if its header is installed.
CHOLMOD = $(eval CHOLMOD := $(shell $(CC) -E -include suitesparse/cholmod.h -x c /dev/null >/dev/null 2>&1 && \
  echo -DHF_BENCH_CHOLMOD -lcholmod))$(CHOLMOD)

COMPILE = $(CC) $(CFLAGS) $(LANGUAGE) $(CODEGEN) $(SANITIZER) $(WARNINGS) $(if $(filter src/%,$<),$(FRAME)) \
  -Iinclude -Isrc $(PKG_CFLAGS)
LINK = $(CC) $(CFLAGS) -fopenmp $(SANITIZER) $(LDFLAGS)

# Build information. Only store/provenance.c is compiled with it, because it writes it into result files. `make dist`
# leaves the commit in .describe.
GIT_DESCRIBE = $(shell test -e .git && git describe --always --dirty --tags 2>/dev/null || \
  cat .describe 2>/dev/null || echo unknown)
COMPILER = $(shell $(CC) --version | head -n 1)
c_string = '"$(subst \,,$(subst ",,$(subst ',,$(strip $(1)))))"'
BUILD_INFO = $(eval BUILD_INFO := -DHF_VERSION=$(call c_string,$(VERSION)) \
  -DHF_GIT_DESCRIBE=$(call c_string,$(GIT_DESCRIBE)) -DHF_COMPILER=$(call c_string,$(COMPILER)) \
  -DHF_BUILD_FLAGS=$(call c_string,$(CFLAGS) $(LANGUAGE) $(CODEGEN) $(SANITIZER)))$(BUILD_INFO)

# ---- Files -----------------------------------------------------------------------------------------------------------
# Kernels are compiled once per instruction set. The program chooses one when it runs.
ISAS := portable avx2 avx512
KERNELS := $(wildcard src/*/*_kernel.c)
sources = $(sort $(foreach room,$(1),$(wildcard src/$(room)/*.c)))
LIB_OBJ := $(patsubst %.c,$(BUILD)/%.o,$(filter-out $(KERNELS),$(call sources,$(LIB_ROOMS)))) \
           $(foreach isa,$(ISAS),$(KERNELS:%.c=$(BUILD)/%_$(isa).o)) $(BUILD)/key_help_text.o
# The page of `hifdm report`: its parts in order, as three strings that report.h declares.
PAGE := $(addprefix src/out/report/,head.html page.css body.html \
          data.js scale.js chart.js table.js net_fast.js net.js net_hand.js cables.js map.js sections.js \
          front.js pattern.js adjust.js tolerance.js requirements.js tensions.js compare.js study.js main.js)
APP_OBJ := $(patsubst %.c,$(BUILD)/%.o,$(call sources,$(APP_ROOMS))) $(BUILD)/report_page_text.o \
           $(BUILD)/words_text.o
TEST_OBJ := $(patsubst %.c,$(BUILD)/%.o,tests/run_tests.c tests/support.c tests/calls.c tests/guards.c \
             $(sort $(wildcard tests/*/test_*.c tests/*/*/test_*.c)))
PROGRAM := $(BUILD)/hifdm
STATIC := $(BUILD)/libhifdm.a
SHARED := $(BUILD)/libhifdm.so
SONAME := libhifdm.so.$(SOVERSION)
RUNNER := $(BUILD)/tests/run_tests
PAPER_OUT ?= results/chen2022
INSTALLED := $(BUILD)/prefix/lib/pkgconfig/hifdm.pc
# The folder below a prefix where PYTHON looks for packages.
PYTHON_PLACE = $(eval PYTHON_PLACE := $(shell $(PYTHON) -c 'import sys, sysconfig; print("lib/python%d.%d/%s-packages" \
  % (*sys.version_info[:2], "dist" if "deb_system" in sysconfig.get_scheme_names() else "site"))'))$(PYTHON_PLACE)
PYTHON_DIR ?= $(PREFIX)/$(PYTHON_PLACE)
PYTHON_FILES := $(wildcard tools/python/hifdm/*.py) tools/python/hifdm/py.typed
BENCH := $(BUILD)/bench/bench
PEERS := $(BUILD)/optimisers/peers
FRONTS := $(BUILD)/optimisers/fronts
BUDGET := $(BUILD)/optimisers/budget
BENCH_OUT ?= results/bench
BENCH_ROUNDS ?= 3
BENCH_OBJ := $(patsubst %.c,$(BUILD)/%.o,$(sort $(wildcard tools/bench/*.c)))
# Harnesses of tests/fuzz, each fuzz_NAME.c, and the calls that tests/fuzz/fuzz.c limits or shortens.
FUZZERS := $(patsubst tests/fuzz/%.c,$(BUILD)/%,$(sort $(wildcard tests/fuzz/fuzz_*.c)))
FUZZ_OBJ := $(FUZZERS:$(BUILD)/%=$(BUILD)/tests/fuzz/%.o) $(BUILD)/tests/fuzz/fuzz.o
FUZZ_WRAP := hf_config_load hf_scene_parabolic_cylinder hf_scene_paraboloid hf_truss_generate \
             hf_truss_ring_generate hf_text_uint64 hf_study_make_points
# The benchmark of a run measures the time of these calls: tools/bench/stages.c.
BENCH_WRAP := hf_config_load hf_config_scene hf_model_build hf_symmetry_apply hf_workspace_create hf_evaluate_form \
              hf_batch_create hf_batch_share hf_optimiser_create hf_batch_run hf_batch_next hf_batch_run_one \
              hf_optimiser_tell hf_refine_run hf_store_create hf_store_form hf_store_generation \
              hf_store_publish hf_store_shape hf_store_complete hf_store_settle

# ---- Output of make, and how it calls itself -------------------------------------------------------------------------
# Lines are short, and there are none if all is up to date. V=1 shows the full commands.
V ?=
Q := $(if $(V),,@)
say = @$(if $(V),:,printf '  %-5s %s\n') '$(1)' '$(2)'
MAKEFLAGS += -r --no-print-directory
# All cores, unless the caller of make has set the number of jobs.
SUB = +$(Q)$(MAKE) $(if $(V),,-s) $(if $(filter -j% --jobserver%,$(MAKEFLAGS)),,-j$(shell nproc))
quote = '$(subst ','\'',$(1))'
# Writes the target only if the text differs, so that targets that depend on it are rebuilt only then.
stamp = @mkdir -p $(@D); printf '%s\n' $(call quote,$(1)) | cmp -s - $@ || printf '%s\n' $(call quote,$(1)) >$@

# ---- Targets to type -------------------------------------------------------------------------------------------------
FRONT := all compile-all run test stress test-under-load mutants browser paper paper-check paper-search literal bench \
         bench-before bench-optimisers bench-auto bench-fronts bench-sampling pretension-night api docs docs-browser \
         lint asan tsan fuzz fuzz-results install uninstall dist dist-check deb workflow-check
FRONT += prose python-install mutants-random attack abi bench-instructions bits transcripts deb-check release-check
.PHONY: $(FRONT) setup fuzzers clean help FORCE
.DEFAULT_GOAL := all
# `make run test` must not build twice at the same time in the same folder.
ifneq ($(filter $(FRONT) setup,$(MAKECMDGOALS)),)
.NOTPARALLEL:
endif

all: ## the program and both libraries, under build/ (or BUILD=...)
	$(SUB) $(PROGRAM) $(STATIC) $(SHARED)

# Shows the warnings of another compiler: `make compile-all BUILD=build/clang CC=clang`.
compile-all: ## everything, the tests too, without running anything
	$(SUB) $(PROGRAM) $(STATIC) $(SHARED) $(RUNNER) $(BENCH)

setup: ## install the packages that are missing
	$(Q)tools/setup.sh

# If the program exists, the packages that it was built from exist, too.
run: ## set up, build, and run CASE (configs/chen2022.yaml) into results/
	$(Q)test -x $(PROGRAM) || tools/setup.sh
	$(SUB) $(PROGRAM)
	@mkdir -p $(dir $(RESULT))
	$(PROGRAM) run $(CASE) -o $(RESULT) --restart

test: ## set up, build and run the tests; SUITE="unit verify/band" picks some
	$(Q)tools/setup.sh --test
	$(SUB) $(PROGRAM) $(RUNNER) $(INSTALLED)
	@mkdir -p $(BUILD)/tmp
	$(Q)HIFDM=$(abspath $(PROGRAM)) HIFDM_SOURCE_DIR=$(CURDIR) PYTHON=$(PYTHON) \
	    HIFDM_PREFIX=$(abspath $(BUILD))/prefix HIFDM_CC=$(call quote,$(CC) $(SANITIZER)) \
	    TMPDIR=$(abspath $(BUILD))/tmp HIFDM_TEST_JOBS=$${HIFDM_TEST_JOBS:-$$(nproc)} \
	    CK_DEFAULT_TIMEOUT=$${CK_DEFAULT_TIMEOUT:-300} $(RUNNER) $(SUITE)

bits: ## write the checksums of results that the suite cli/bits compares with: tests/verify/data/bits.txt
	$(Q)rm -rf $(BUILD)/bits.new && mkdir -p $(BUILD)/bits.new
	+$(Q)HIFDM_BITS=$(abspath $(BUILD))/bits.new $(MAKE) test SUITE=cli/bits
	$(Q)LC_ALL=C; cat $(BUILD)/bits.new/* >tests/verify/data/bits.txt

transcripts: ## write what the program says now into the files that the suite cli/transcripts compares with
	+$(Q)HIFDM_TRANSCRIPTS=write $(MAKE) test SUITE=cli/transcripts

# FUZZ_SEED=... repeats a run; `python3 tests/fuzz/fuzz_results.py --only N` repeats one of its files.
FUZZ_N ?= 5000
FUZZ_SEED ?= $(shell date +%s)
fuzz-results: ## FUZZ_N damaged result files against every command that reads one, with sanitizers
	$(Q)tools/setup.sh --test
	$(SUB) BUILD=build/asan SANITIZE=address,undefined CFLAGS='-O2 -g' WERROR= build/asan/hifdm
	$(PYTHON) tests/fuzz/fuzz_results.py --program build/asan/hifdm --n $(FUZZ_N) --seed $(FUZZ_SEED)

# Tries twenty times as many nets as `make test`, ten times as many kills, and each failing call.
stress: ## the numerical-stability suite, killed runs and failing calls at full length
	+$(Q)HIFDM_STRESS=1 CK_DEFAULT_TIMEOUT=1800 $(MAKE) test SUITE="stress cli/resume store_calls"

# RUNS=20 is the number of runs. CLONE=yes adds one in a fresh clone. SUITE=... is as for test.
test-under-load: ## the tests again and again beside a busy loop on every core
	+$(Q)RUNS=$(RUNS) CLONE=$(CLONE) SUITE=$(call quote,$(SUITE)) BUILD=$(BUILD) tools/test_under_load.sh

# Takes hours. MUTANTS="WORD..." selects some. tests/mutants.txt has the list.
mutants: ## one fault in the sources at a time: which ones do the tests miss?
	$(Q)tools/setup.sh --test
	+$(Q)BUILD=$(BUILD) $(PYTHON) tools/mutants.py $(MUTANTS)

# SEED=... is a hexadecimal number, by default the first eight digits of the commit; N=... is the number of edits.
# MUTANTS_ARGS="--suite unit --enough 0.7" runs only such suites, and gives exit status 0 from this share on.
SEED ?= $(shell git rev-parse --short=8 HEAD 2>/dev/null | cut -c1-8)
N ?= 200
MUTANTS_ARGS ?=
mutants-random: ## N edits at random places that SEED draws: which do the tests miss? build/mutants-random/SEED.log
	$(Q)tools/setup.sh --test
	+$(Q)BUILD=$(BUILD) $(PYTHON) tools/mutants_random.py --seed $(SEED) --n $(N) $(MUTANTS_ARGS)

abi: ## does the library export what the public headers declare, and nothing is gone? do files call in cycles?
	$(SUB) $(SHARED) $(PROGRAM)
	$(Q)$(PYTHON) tools/abi.py $(SHARED)
	$(Q)$(PYTHON) tools/cycles.py $(BUILD)

attack: ## 200 kills, 500 failing calls and 5000 flipped bits that SEED draws: results/release/attack-VERSION.log
	$(Q)tools/setup.sh --test
	$(SUB) $(PROGRAM)
	$(Q)$(PYTHON) tests/fault/attack.py --program $(PROGRAM) --seed 0x$(SEED) --log results/release/attack-$(VERSION).log

browser: ## open pages of hifdm report in headless Chromium; needs `tools/setup.sh --ci`
	$(SUB) $(PROGRAM)
	$(Q)HIFDM=$(abspath $(PROGRAM)) BUILD=$(BUILD) tests/browser/run.sh

# PAPER_OUT=... is another folder to write to, or to compare with.
paper: PAPER_DO := --out
paper: ## the figures and numbers of Chen et al. 2022, ours next to theirs, in results/chen2022/
paper-check: PAPER_DO := --check
paper-check: ## hold the numbers in results/chen2022/ to what the program gives now
paper paper-check:
	$(Q)tools/setup.sh --test
	$(SUB) $(PROGRAM)
	$(PYTHON) tools/paper/paper.py --program $(PROGRAM) --work $(BUILD)/paper $(PAPER_DO) $(PAPER_OUT)

paper-search: ## search for the paper's net anew (an hour): configs/chen2022-search*.yaml, results/chen2022/dense*.csv
	$(Q)tools/setup.sh --test
	$(SUB) $(PROGRAM)
	$(PYTHON) tools/paper/search.py --program $(PROGRAM) --work $(BUILD)/paper-search
	$(PYTHON) tools/paper/dense.py --program $(PROGRAM) --work $(BUILD)/paper-search

# LITERAL_ROUNDS=... is the number of interleaved runs of each.
LITERAL_ROUNDS ?= 7
literal: setup ## the paper's literal evaluation of an individual beside the default: psi and time on CASE
	$(SUB) $(PROGRAM)
	$(PYTHON) tools/literal.py --program $(PROGRAM) --case $(CASE) --work $(BUILD)/literal --rounds $(LITERAL_ROUNDS)

# Peers that cannot be installed are left out of the tables. BENCH_OUT=... writes to another folder, in which each
# processor has a folder.
bench: ## benchmark against LAPACK, CHOLMOD and scipy: tables and figures in results/bench/PROCESSOR (5 minutes)
	$(Q)tools/setup.sh --bench || tools/setup.sh
	$(SUB) $(PROGRAM) $(SHARED) $(BENCH)
	@mkdir -p $(BENCH_OUT)
	$(PYTHON) tools/bench/run.py --driver $(BENCH) --program $(PROGRAM) --work $(BUILD)/bench --out $(BENCH_OUT) \
	    --rounds $(BENCH_ROUNDS) --flags $(call quote,$(COMPILER); $(CFLAGS) $(LANGUAGE) $(CODEGEN))
	$(BENCH) antenna $(BUILD)/bench | tee $(BENCH_OUT)/antenna.txt
	HIFDM_LIBRARY=$(abspath $(SHARED)) PYTHONPATH=tools/python PYTHONDONTWRITEBYTECODE=1 \
	    $(PYTHON) tools/bench/python_batch.py --program $(PROGRAM) --work $(BUILD)/bench

# COMMIT=... is another commit than 2161b94, OPENBLAS=.../libblas.so.3 is the BLAS for both, CASES="FILE..." adds nets.
COMMIT ?= 2161b94
bench-before: ## form-finding now against an old commit's, side by side: before.csv in results/bench/PROCESSOR
	$(Q)tools/setup.sh --bench || tools/setup.sh
	$(SUB) $(STATIC) $(BENCH)
	$(Q)OPENBLAS=$(OPENBLAS) $(PYTHON) tools/bench/before.py --library $(STATIC) --driver $(BENCH) \
	    --work $(BUILD)/before --out $(BENCH_OUT) --commit $(COMMIT) --rounds $(BENCH_ROUNDS) $(CASES)

# RECORD=yes writes the table, for the commit that all others are compared with. CASES="reflector 41x49" selects cases.
RECORD ?=
bench-instructions: ## instructions of three cases on one thread against results/bench/instructions.csv (2 minutes)
	$(Q)tools/setup.sh --instructions
	$(SUB) $(PROGRAM)
	$(PYTHON) tools/bench/instructions.py --program $(PROGRAM) --work $(BUILD)/instructions \
	    --table results/bench/instructions.csv $(if $(RECORD),--record) $(CASES)

# Results are the same on every processor, except for what pagmo's mathematics makes of last bits.
# OPTIMISER_ONLY=TEXT runs only the nets with this text in their name and keeps the rows of the others, so that the
# benchmark can run in parts, one after another.
OPTIMISER_SEEDS ?= 7
OPTIMISER_ONLY ?=
bench-optimisers: ## our genetic algorithm beside pagmo's, nlopt's, scipy's: results/bench/optimisers* (hours)
	$(Q)tools/setup.sh --optimisers
	$(SUB) $(PROGRAM) $(PEERS)
	@mkdir -p $(BENCH_OUT)
	$(PYTHON) tools/optimisers/run.py --driver $(PEERS) --program $(PROGRAM) --seeds $(OPTIMISER_SEEDS) \
	    --only $(call quote,$(OPTIMISER_ONLY)) --out $(BENCH_OUT)

bench-auto: ## `method: auto` from 20 seeds beside nlopt and pagmo: results/bench/auto.csv, best.csv, caps.csv (30 min)
	$(Q)tools/setup.sh --optimisers
	$(SUB) $(PROGRAM) $(BUDGET)
	@mkdir -p $(BENCH_OUT)
	$(PYTHON) tools/optimisers/auto.py --driver $(BUDGET) --program $(PROGRAM) --out $(BENCH_OUT)
	$(PYTHON) tools/optimisers/caps.py --program $(PROGRAM) --out $(BENCH_OUT)

bench-fronts: ## fronts of two and three objectives beside pagmo's NSGA-II: results/bench/fronts.csv (2 minutes)
	$(Q)tools/setup.sh --optimisers
	$(SUB) $(FRONTS)
	@mkdir -p $(BENCH_OUT)
	$(PYTHON) tools/optimisers/fronts.py --driver $(FRONTS) --seeds $(OPTIMISER_SEEDS) --out $(BENCH_OUT)

bench-sampling: ## random beside quasi-random samples of a net as built: results/bench/sampling.* (2 minutes)
	$(SUB) $(PROGRAM)
	@mkdir -p $(BENCH_OUT)
	$(PYTHON) tools/bench/sampling.py --program $(PROGRAM) --work $(BUILD)/sampling --out $(BENCH_OUT)

pretension-night: ## which pretension, with errors of the cut: results/pretension/night* (3 minutes)
	$(SUB) $(PROGRAM)
	$(PYTHON) tools/paper/night.py --program $(PROGRAM) --work $(BUILD)/night --out results/pretension

# Pages are made from the comments of the headers: tools/api/filter.awk. A warning of doxygen is an error.
api: ## the library's interface as pages, from the public headers: build/api/index.html
	$(Q)tools/setup.sh --api
	@rm -rf $(BUILD)/api && mkdir -p $(BUILD)/api
	$(Q){ cat tools/api/Doxyfile; printf '%s\n' 'OUTPUT_DIRECTORY = "$(BUILD)/api"' 'PROJECT_NUMBER = $(VERSION)'; } | \
	    doxygen -
	@echo $(BUILD)/api/index.html

docs: ## the manual as pages to search and to read offline: build/docs/index.html
	$(Q)tools/setup.sh --test --docs
	$(SUB) $(PROGRAM) $(RUNNER) $(INSTALLED)
	+$(PYTHON) tools/docs/build.py --program $(PROGRAM) --version $(VERSION) --make "$(MAKE)" --work $(BUILD)/docs.src \
	    --out $(BUILD)/docs

docs-browser: docs ## every page of the manual in headless Chromium, on a phone; needs `tools/setup.sh --ci`
	$(Q)HIFDM=$(abspath $(PROGRAM)) BUILD=$(BUILD) DOCS=$(BUILD)/docs \
	    tests/browser/run.sh --node tests/browser/manual.mjs

prose: ## check the words of documents and program by tools/prose/terms.yml; needs npm
	$(Q)tools/prose/run.sh

lint: ## check the rules of the house
	+$(Q)tools/lint.sh

# With -O2 the longest tests take a third of the time with -O1. There is no -Werror, because instrumented code causes
# false warnings. Instrumented code is slow, so there is a multiplier; the time limits of the tests follow it, too. The
# quarantine is small. The runner forks each test, and what the quarantine holds is copied and searched for leaks each
# time.
asan: ## the tests under the address and undefined-behaviour sanitizers, in build/asan
	+$(Q)ASAN_OPTIONS=detect_leaks=1:detect_stack_use_after_return=1:quarantine_size_mb=16 \
	    UBSAN_OPTIONS=print_stacktrace=1 \
	    CK_TIMEOUT_MULTIPLIER=5 $(MAKE) BUILD=build/asan SANITIZE=address,undefined CFLAGS='-O2 -g' WERROR= test

# clang is used because gcc's OpenMP runtime hides its barriers from the thread sanitizer. OpenBLAS and HDF5 are not
# instrumented, so what happens inside them is ignored. setarch -R: clang 14 cannot place its shadow memory on kernels
# that randomise addresses widely.
tsan: ## a short run of TSAN_CASE, and some points of a sweep, under the thread sanitizer, in build/tsan
	$(Q)tools/setup.sh --ci
	$(SUB) BUILD=build/tsan CC=clang SANITIZE=thread CFLAGS='-O1 -g' WERROR= build/tsan/hifdm
	$(TSAN_RUN) run $(TSAN_CASE) $(TSAN_ARGS) -o build/tsan/out.h5 --force
	@rm -rf build/tsan/sweep.d
	$(TSAN_RUN) sweep configs/pretension-sweep.yaml --task 0 --tasks 16 --threads 3 --dir build/tsan/sweep.d
TSAN_RUN = OMP_NUM_THREADS=4 TSAN_OPTIONS=ignore_noninstrumented_modules=1 $(NO_ASLR) build/tsan/hifdm
NO_ASLR = $(shell setarch -R true 2>/dev/null && echo setarch -R)

# FUZZ="case net" selects harnesses. Each runs for FUZZ_SECONDS=60, or for FUZZ_RUNS=1000000, with FUZZ_SEED=... and
# FUZZ_JOBS=2 at a time. With -O1 there are twice as many inputs per second as with -O0, and compiling takes no longer.
fuzz: ## inputs that a fuzzer makes up, under the sanitizers, in build/fuzz; findings and how to repeat them are printed
	$(Q)tools/setup.sh --ci
	$(SUB) BUILD=build/fuzz CC=clang SANITIZE=address,undefined,fuzzer-no-link CFLAGS='-O1 -g' WERROR= fuzzers
	$(Q)tests/fuzz/run.sh build/fuzz $(FUZZ)

fuzzers: $(FUZZERS) $(PROGRAM)

# Names of files in lists, and of folders for rm -rf, end at a blank.
no_blanks = $(foreach name,$(1),$(if $(word 2,x$($(name))x),$(error \
    $(name)='$($(name))' has a blank: install into a folder without one)))

install: all ## install under PREFIX (/usr/local), within DESTDIR if given
	$(call no_blanks,PREFIX DESTDIR LIB $(filter PYTHON_DIR,$(MAKECMDGOALS:python-install=PYTHON_DIR)))
	$(call install_files,$(DESTDIR)$(PREFIX),$(PREFIX))

# PYTHON_DIR=... is another folder than that of PYTHON's version below PREFIX.
python-install: install ## install, and the package hifdm for Python with it, into PYTHON_DIR
	$(call install_python,$(DESTDIR)$(PYTHON_DIR))
	@echo 'the package is in $(DESTDIR)$(PYTHON_DIR); if $(PYTHON) does not look there, add it to PYTHONPATH'

define install_python
$(Q)install -d $(1)/hifdm
$(Q)install -m 644 $(PYTHON_FILES) $(1)/hifdm/
endef

# Needs the same PREFIX, LIB, PYTHON_DIR and DESTDIR as the installation. Folders that others use, too, remain.
uninstall: ## remove what `make install` or `make python-install` of this version has put there
	$(call no_blanks,PREFIX DESTDIR LIB PYTHON_DIR)
	$(Q)rm -f $(addprefix $(DESTDIR)$(PREFIX)/,bin/hifdm share/man/man1/hifdm.1 \
	    share/bash-completion/completions/hifdm $(addprefix $(LIB)/,libhifdm.a libhifdm.so $(SONAME) \
	    libhifdm.so.$(VERSION) pkgconfig/hifdm.pc) $(wildcard include/hifdm/*.h))
	$(Q)rmdir --ignore-fail-on-non-empty $(DESTDIR)$(PREFIX)/include/hifdm 2>/dev/null || true
	$(Q)rm -f $(addprefix $(DESTDIR)$(PYTHON_DIR)/hifdm/,$(notdir $(PYTHON_FILES)))
	$(Q)rm -rf $(DESTDIR)$(PYTHON_DIR)/hifdm/__pycache__
	$(Q)rmdir $(DESTDIR)$(PYTHON_DIR)/hifdm 2>/dev/null || true

# The files and their folders: $(call install_files,FOLDER,PREFIX under which the files will be found).
define install_files
$(Q)install -d $(addprefix $(1)/,bin $(LIB)/pkgconfig include/hifdm share/man/man1 share/bash-completion/completions)
$(Q)install -m 755 $(PROGRAM) $(1)/bin/
$(Q)install -m 644 $(STATIC) $(1)/$(LIB)/
$(Q)install -m 755 $(SHARED) $(1)/$(LIB)/libhifdm.so.$(VERSION)
$(Q)ln -sf libhifdm.so.$(VERSION) $(1)/$(LIB)/$(SONAME)
$(Q)ln -sf $(SONAME) $(1)/$(LIB)/libhifdm.so
$(Q)install -m 644 include/hifdm/*.h $(1)/include/hifdm/
$(Q)printf '%s\n' 'prefix=$(2)' 'Name: hifdm' 'Version: $(VERSION)' \
    'Description: Form finding of cable nets with force densities' 'Cflags: -I$${prefix}/include' \
    'Libs: -L$${prefix}/$(LIB) -lhifdm' 'Requires.private: gsl hdf5 zlib yaml-0.1' \
    'Libs.private: -fopenmp -ldl -lm' >$(1)/$(LIB)/pkgconfig/hifdm.pc
$(Q)$(PROGRAM) help --man >$(1)/share/man/man1/hifdm.1
$(Q)$(PROGRAM) help --bash >$(1)/share/bash-completion/completions/hifdm
endef

# The tarball has what is committed, and the commit. The same commit gives the same bytes.
DIST := $(BUILD)/dist/hifdm-$(VERSION)
dist: ## a tarball of what is committed, which builds and is tested without git: build/dist/hifdm-VERSION.tar.gz
	$(Q)test -e .git || { echo 'make dist: takes what is committed, so it needs a checkout of git' >&2; exit 1; }
	@mkdir -p $(DIST)
	$(Q)git describe --always --tags >$(DIST)/.describe
	$(Q)git archive --format=tar --prefix=hifdm-$(VERSION)/ --add-file=$(DIST)/.describe -o $(DIST).tar HEAD
	$(Q)gzip -9n <$(DIST).tar >$(DIST).tar.gz.new
	$(Q)mv $(DIST).tar.gz.new $(DIST).tar.gz
	@rm $(DIST).tar
	@echo $(DIST).tar.gz

# Needs nothing but what `make` needs. SUITE="..." also runs those tests there.
dist-check: dist ## build that tarball without git, install and uninstall it, run a case with it
	+$(Q)SUITE=$(call quote,$(SUITE)) tools/packages/check_dist.sh $(DIST).tar.gz $(BUILD)/dist/check

# tools/debian has the recipe, and the tarball the sources. If lintian is installed, it checks the packages.
deb: dist ## Debian packages of that tarball: program, library, headers, Python: build/deb/*.deb
	$(Q)tools/setup.sh --deb
	+$(Q)tools/packages/make_deb.sh $(DIST).tar.gz $(BUILD)/deb

# RELEASE=trixie is another Debian than that of this machine. WITH="libopenblas0-pthread" installs another BLAS in the
# root.
deb-check: deb ## install those packages in a bare root of debootstrap, run them there, and purge them (needs root)
	$(Q)RELEASE=$(RELEASE) WITH=$(call quote,$(WITH)) tools/packages/check_deb.sh $(BUILD)/deb $(BUILD)/deb-root

# STEPS="fuzz stress" selects steps. The log is committed for the release that it was run on.
release-check: ## what takes longer than .ci/run (hours): results/release/VERSION.log
	$(Q)tools/release_check.sh $(STEPS)

workflow-check: ## the rules for Snakemake, tools/packages/Snakefile, with Snakemake itself
	$(Q)tools/setup.sh --workflows
	$(SUB) $(PROGRAM)
	$(Q)tools/packages/check_workflows.sh $(PROGRAM) $(BUILD)/workflows

clean: ## remove build/
	rm -rf build $(BUILD)

help: ## this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-15s %s\n", $$1, $$2 }' Makefile

# Prints the value of a variable, for tools/lint.sh.
print-%:
	@echo '$($*)'

# ---- Files that are made ---------------------------------------------------------------------------------------------
$(BUILD)/flags: FORCE
	$(call stamp,$(COMPILE) $(LINK) $(PKG_LIBS))

$(BUILD)/info: FORCE
	$(call stamp,$(BUILD_INFO))

$(BUILD)/lapack: FORCE
	$(call stamp,$(LAPACK))

$(BUILD)/src/linalg/lapack.o: $(BUILD)/lapack
$(BUILD)/src/linalg/lapack.o: EXTRA = -DHF_LAPACK='$(foreach name,$(LAPACK),"$(name)",)'
$(BUILD)/src/store/provenance.o: $(BUILD)/info
$(BUILD)/src/store/provenance.o: EXTRA = $(BUILD_INFO)
$(BUILD)/tests/%.o: EXTRA = -Itests $(filter-out -l%,$(CHECK))

# On other machines than x86-64 all of them are the portable one, and the program chooses that.
X86 = $(eval X86 := $(filter x86_64-%,$(shell $(CC) -dumpmachine)))$(X86)
FLAGS_avx2 = $(if $(X86),-mavx2 -mfma)
FLAGS_avx512 = $(if $(X86),-mavx512f -mprefer-vector-width=512)
# gcc 12's address sanitizer has its own stack to find uses after a return. It is not aligned for 512-bit vectors.
FLAGS_kernel := $(if $(findstring address,$(SANITIZE)),$(if $(findstring clang,$(CC)),,--param=asan-stack=0))
define kernel_rule
$(BUILD)/src/%_kernel_$(1).o: EXTRA = -DHF_ISA=$(1) $$(FLAGS_$(1)) $$(FLAGS_kernel)
$(BUILD)/src/%_kernel_$(1).o: src/%_kernel.c $(BUILD)/flags
	$$(call say,CC,$$< ($(1)))
	@mkdir -p $$(@D)
	$$(Q)$$(COMPILE) $$(EXTRA) -MMD -MP -c $$< -o $$@
endef
$(foreach isa,$(ISAS),$(eval $(call kernel_rule,$(isa))))

$(BUILD)/%.o: %.c $(BUILD)/flags
	$(call say,CC,$<)
	@mkdir -p $(@D)
	$(Q)$(COMPILE) $(EXTRA) -MMD -MP -c $< -o $@

# Embedded files are arrays of bytes and not strings, because C does not guarantee string literals of this length.
# $(call bytes,declaration,files) prints one.
bytes = echo "$(1)[] = {"; cat $(2) | od -An -v -tx1 | sed "s/[0-9a-f][0-9a-f]*/'\\\\x&',/g"; echo '0};'
$(BUILD)/report_page_text.c: $(PAGE) Makefile
	$(call say,PAGE,$@)
	@mkdir -p $(@D)
	$(Q){ echo '#include "out/report.h"'; \
	  $(call bytes,const char hf_report_page_head,$(wordlist 1,2,$(PAGE))); \
	  $(call bytes,const char hf_report_page_body,$(word 3,$(PAGE))); \
	  $(call bytes,const char hf_report_page_script,$(wordlist 4,99,$(PAGE))); } >$@.tmp
	$(Q)mv $@.tmp $@

$(BUILD)/words_text.c: src/manual/glossary.md Makefile
	$(call say,PAGE,$@)
	@mkdir -p $(@D)
	$(Q){ echo '#include "out/words.h"'; $(call bytes,char hf_words_text,$<); } >$@.tmp
	$(Q)mv $@.tmp $@

# Of keys.md, each path with its paragraph in one line; a NUL ends each of them.
$(BUILD)/key_help_text.c: src/case/keys.md Makefile
	$(call say,PAGE,$@)
	@mkdir -p $(@D)
	$(Q)awk -v RS= '/^### / { n = split(substr($$0, 5), path, ", "); next } \
	  n { sub(/\n+$$/, ""); gsub(/\n/, " "); for (i = 1; i <= n; i++) print path[i] "\n" $$0; n = 0 }' $< >$@.lines
	$(Q)tr '\n' '\0' <$@.lines >$@.bytes
	$(Q){ echo '#include "case/config_key.h"'; $(call bytes,const char hf_config_help_text,$@.bytes); } >$@.tmp
	$(Q)mv $@.tmp $@

$(BUILD)/%_text.o: $(BUILD)/%_text.c $(BUILD)/flags
	$(call say,CC,$<)
	$(Q)$(COMPILE) -MMD -MP -c $< -o $@

# The Makefile is a prerequisite of what is linked, because it lists the parts.
$(STATIC): $(LIB_OBJ) Makefile
	$(call say,AR,$@)
	$(Q)rm -f $@ && $(AR) rcs $@ $(LIB_OBJ)

$(SHARED): $(LIB_OBJ) Makefile
	$(call say,LD,$@)
	$(Q)$(LINK) -shared -Wl,-soname,$(SONAME) -Wl,-z,defs -o $@ $(LIB_OBJ) $(PKG_LIBS)
	$(Q)ln -sf $(@F) $(@D)/$(SONAME)

$(PROGRAM): $(APP_OBJ) $(STATIC)
	$(call say,LD,$@)
	$(Q)$(LINK) -o $@ $^ $(PKG_LIBS)

$(PEERS) $(FRONTS) $(BUDGET): $(BUILD)/optimisers/%: tools/optimisers/%.cpp tools/optimisers/unit_cube.hpp $(STATIC) \
                              Makefile
	$(call say,LD,$@)
	$(Q)mkdir -p $(@D)
	$(Q)$(CXX) -O2 -std=c++17 -Wall -Iinclude $$(pkg-config --cflags eigen3) $(LDFLAGS) -o $@ $< $(STATIC) -fopenmp \
	    -lpagmo -lboost_serialization -ltbb -lnlopt_cxx -lnlopt $(PKG_LIBS)

$(RUNNER): $(TEST_OBJ) $(filter-out $(BUILD)/src/app/main.o,$(APP_OBJ)) $(STATIC)
	$(call say,LD,$@)
	$(Q)$(LINK) $(patsubst %,-Wl$(comma)--wrap=%,$(TEST_WRAP) $(TEST_WRAP_EXTRA)) -o $@ $^ \
	    $(filter-out -I%,$(CHECK)) $(PKG_LIBS)
comma := ,

# An installation for the tests of the examples, which are built as a user would build them.
$(INSTALLED): $(PROGRAM) $(STATIC) $(SHARED) $(wildcard include/hifdm/*.h) $(PYTHON_FILES) Makefile
	$(call say,INST,$(BUILD)/prefix)
	$(call install_files,$(abspath $(BUILD))/prefix,$(abspath $(BUILD))/prefix)
	$(call install_python,$(abspath $(BUILD))/prefix/$(PYTHON_PLACE))

$(BUILD)/bench/peers: FORCE
	$(call stamp,$(CHOLMOD))

$(BENCH_OBJ): $(BUILD)/bench/peers
$(BENCH_OBJ): EXTRA = $(filter -D%,$(CHOLMOD))

$(BENCH): $(BENCH_OBJ) $(STATIC)
	$(call say,LD,$@)
	$(Q)$(LINK) $(patsubst %,-Wl$(comma)--wrap=%,$(BENCH_WRAP)) -o $@ $^ $(filter -l%,$(CHOLMOD)) $(PKG_LIBS)

$(FUZZERS): $(BUILD)/%: $(BUILD)/tests/fuzz/%.o $(BUILD)/tests/fuzz/fuzz.o $(filter-out %/main.o,$(APP_OBJ)) $(STATIC)
	$(call say,LD,$@)
	$(Q)$(LINK) -fsanitize=fuzzer $(patsubst %,-Wl$(comma)--wrap=%,$(FUZZ_WRAP)) -o $@ $^ $(PKG_LIBS)

# The targets to type make no files by themselves, and reading these files takes a while.
ifneq ($(filter-out $(FRONT) setup clean help print-%,$(MAKECMDGOALS)),)
-include $(LIB_OBJ:.o=.d) $(APP_OBJ:.o=.d) $(TEST_OBJ:.o=.d) $(BENCH_OBJ:.o=.d) $(FUZZ_OBJ:.o=.d)
endif
