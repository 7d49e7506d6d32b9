# The commands of the book. They need nothing but Python 3.11 or newer: each
# sets up what it needs in .venv and node_modules, from exact pins.

PYTHON ?= python3
PORT ?= 8000
VENV := .venv
RUN := $(VENV)/bin/python
PAGES := packages/notebook-pages/src/notebook_pages
PIP := $(RUN) -m pip install --quiet --disable-pip-version-check --no-build-isolation --no-compile --constraint constraints.txt

# Kernels see this book's settings and nobody's own.
export IPYTHONDIR := $(CURDIR)/_build/ipython
export MPLCONFIGDIR := $(CURDIR)/_build/matplotlib
# Python keeps what it has compiled, whatever is set outside: hundreds of processes load the same modules.
unexport PYTHONDONTWRITEBYTECODE
KERNEL_SETTINGS := _build/ipython/profile_default/ipython_kernel_config.py

.PHONY: help setup book serve new-chapter new-question check test test-all take-away numpy notebooks release renew-pins benchmark anywhere mutants programs clean

help:
	@echo "make book       build the site into _build/html"
	@echo "make serve      build it, serve it on a local address and print the address"
	@echo "make take-away  build it with the whole book as a PDF, as an EPUB and as a zip"
	@echo "make numpy      fetch NumPy and Matplotlib for browsers; BOOK_NUMPY=_build/numpy make book then puts them beside the pages"
	@echo "make new-chapter NAME=belt-trick TITLE='The belt trick'   a chapter with all its parts (AFTER=gimbal-lock: not the last one)"
	@echo "make new-question NAME=belt-trick/twist TITLE='A twist' KIND='quaternion'   a question for it"
	@echo "make check      style, types, pins and what a chapter needs (nothing is built)"
	@echo "make test       try every part of the book and its software (minutes)"
	@echo "make test-all   run every test, as every night"
	@echo "make notebooks  run every notebook and store it with its outputs"
	@echo "make release    make the exercises from the notebooks with solutions, and try them (ONLY=belt-trick: those of one)"
	@echo "make anywhere   compare all numbers with those of other processors, and with WebAssembly"
	@echo "make mutants    change the mathematics and the checking in thousands of places, and see which change no test notices (hours)"
	@echo "make programs   ask the programs of the convention card, in their newest versions, what they answer now (fetches gigabytes)"
	@echo "make benchmark  compare with other libraries"
	@echo "make renew-pins pin the newest versions of all that is installed"
	@echo "make setup      set up what the book needs, as the commands above do by themselves"
	@echo "make clean      remove what was built, not what was set up"

# What each command installs: the projects of this repository, with some of their extras. The book itself needs neither
# a browser nor the tests.
PROJECTS_book := . ./packages/coursework ./packages/notebook-pages ./packages/orientation-lab
PROJECTS_print := . ./packages/coursework ./packages/notebook-pages[print] ./packages/orientation-lab
PROJECTS_release := . ./packages/coursework[tools] ./packages/notebook-pages ./packages/orientation-lab
PROJECTS_test := .[test] ./packages/coursework[tools,cluster,test] ./packages/notebook-pages[print,test] ./packages/orientation-lab[test]
PROJECTS_mutants := .[test] ./packages/coursework[tools,cluster,test] ./packages/notebook-pages[print,test] ./packages/orientation-lab[test,mutants]
# What else each of these installations covers.
COVERS_print := book
COVERS_release := book
COVERS_test := book print release
COVERS_mutants := book print release test
# Two commands of pip at once would write into one environment; what takes long works side by side by itself.
.NOTPARALLEL:

setup: $(VENV)/ready-book node_modules/ready $(VENV)/runtime/ready $(KERNEL_SETTINGS)

$(VENV)/bin/python:
	@$(PYTHON) -c "import sys; sys.exit(sys.version_info < (3, 11) and 'The book needs Python 3.11 or newer; this is ' + sys.version.split()[0] + '. Name one: make PYTHON=python3.12')"
	@$(PYTHON) -m venv $(VENV)

$(VENV)/ready-%: constraints.txt $(wildcard pyproject.toml packages/*/pyproject.toml) | $(VENV)/bin/python
	@echo "Setting up Python in $(VENV) for: $(PROJECTS_$*) ..."
	@$(PIP) setuptools
	@$(PIP) $(addprefix --editable ,$(PROJECTS_$*))
	@touch $@ $(COVERS_$*:%=$(VENV)/ready-%)

node_modules/ready: $(PAGES)/package-lock.json | $(VENV)/ready-book
	@$(RUN) -m notebook_pages.set_up packages
	@touch $@

$(VENV)/runtime/ready: $(PAGES)/live/wheels.txt $(PAGES)/lite/wheels.txt | $(VENV)/ready-book
	@$(RUN) -m notebook_pages.set_up wheels
	@touch $@

$(KERNEL_SETTINGS): $(PAGES)/ipython_kernel_config.py
	@mkdir -p $(@D)
	@cp $< $@

book: setup
	@$(RUN) -m notebook_pages.build

serve: book
	@$(RUN) -m notebook_pages.serve $(PORT)

take-away: $(VENV)/ready-print book
	@$(RUN) -m notebook_pages.whole_book

# Pages built with BOOK_NUMPY=_build/numpy ask no other server for anything. Each file is compared with its fingerprint.
numpy: setup
	@$(RUN) -m notebook_pages.live.fetch _build/numpy

# AFTER names the chapter that the new one follows. The new one's exercises are released, so that the book builds.
new-chapter: $(VENV)/ready-release setup
	@$(RUN) -m tools.new chapter "$(NAME)" "$(TITLE)" $(if $(AFTER),--after "$(AFTER)")
	@$(RUN) -m coursework release "$(NAME)" chapters

new-question: setup
	@$(RUN) -m tools.new question "$(NAME)" "$(TITLE)" $(if $(KIND),--kind "$(KIND)")

check: $(VENV)/ready-test setup
	@$(RUN) -m pytest -q tests/test_style.py tests/test_pins.py tests/chapters/test_chapters.py

# One process more than there are cores. What takes long and rarely breaks is left to `make test-all`.
test: $(VENV)/ready-test book
	@$(RUN) -m notebook_pages.browser || true
	@$(RUN) -m pytest -n auto -m "not long"

# The PDF is printed by a browser; where there is none, the tests that need one are skipped.
test-all: $(VENV)/ready-test book
	@if $(RUN) -m notebook_pages.browser; then $(RUN) -m notebook_pages.whole_book; fi
	@$(RUN) -m pytest -n auto

notebooks: setup
	@$(RUN) -m notebook_pages.notebooks

release: $(VENV)/ready-release setup
	@$(RUN) -m coursework release $(ONLY)
	@$(RUN) -m coursework selftest $(ONLY)

# Cells, releases and doctests, computed as other processors would (ONLY=unit-quaternions: those of one notebook).
anywhere: $(VENV)/ready-test setup
	@$(RUN) -m tools.anywhere $(ONLY)

# Each change that survives is printed when it is found: a test is missing, or it changes nothing (ONLY="quaternions metrics").
mutants: $(VENV)/ready-mutants setup
	@$(RUN) -m tools.mutants orientation $(ONLY) && code=0 || code=1; \
		$(if $(ONLY),,$(RUN) -m tools.mutants coursework.checking || code=1;) exit $$code

# Prints where an answer differs from the stored one.
programs: setup
	@$(RUN) -m tools.programs

renew-pins: setup
	@$(RUN) -m notebook_pages.pins

benchmark: $(VENV)/ready-test setup
	@$(RUN) -m tools.benchmarks

clean:
	rm -rf _build
