# The commands of the book. They need only Python, from 3.11 to 3.15. Each command
# installs what it needs into .venv and node_modules, from exact pins.

PYTHON ?= python3
PORT ?= 8000
VENV := .venv
RUN := $(VENV)/bin/python
PAGES := packages/notebook-pages/src/notebook_pages
PIP := $(RUN) -m pip install --quiet --disable-pip-version-check --no-build-isolation --no-compile --constraint constraints.txt

# Kernels use this book's settings, not the user's own.
export IPYTHONDIR := $(CURDIR)/_build/ipython
export MPLCONFIGDIR := $(CURDIR)/_build/matplotlib
# Let Python store compiled modules even if the user's settings forbid it, since hundreds of processes load them.
unexport PYTHONDONTWRITEBYTECODE
KERNEL_SETTINGS := _build/ipython/profile_default/ipython_kernel_config.py

.PHONY: help setup book serve new-chapter new-question check quick test test-rest take-away numpy notebooks release renew-pins benchmark anywhere oldest mutants programs clean

help:
	@echo "make book       build the site into _build/html"
	@echo "make serve      build the site, serve it on this machine and print the address"
	@echo "make take-away  build the site, with the whole book as a PDF, an EPUB and a zip"
	@echo "make numpy      download NumPy and Matplotlib for browsers; BOOK_NUMPY=_build/numpy make book then adds them to the site"
	@echo "make new-chapter NAME=belt-trick TITLE='The belt trick'   add a chapter with all its parts (AFTER=gimbal-lock puts it after that chapter, not at the end)"
	@echo "make new-question NAME=belt-trick/twist TITLE='A twist' KIND='quaternion'   add a question to that chapter"
	@echo "make check      check style, types, pins and the parts of each chapter (builds nothing)"
	@echo "make quick      run the tests of what has changed since main, or since another commit (BASE=HEAD~1)"
	@echo "make test       test the book and its software (takes minutes)"
	@echo "make test-rest  run the tests that make test leaves out: the whole book on paper, other browsers, clusters"
	@echo "make notebooks  run every notebook and store its outputs"
	@echo "make release    build the exercises from the notebooks with solutions, and test them (ONLY=belt-trick builds one)"
	@echo "make anywhere   compare all numbers with those of other processors"
	@echo "make oldest     test the module with the oldest versions of its dependencies that it allows"
	@echo "make mutants    make thousands of small changes to the mathematics, and list those that no test notices (takes hours)"
	@echo "make programs   run the newest versions of the programs on the convention card, and compare their answers (downloads gigabytes)"
	@echo "make benchmark  compare the speed with that of other libraries"
	@echo "make renew-pins pin the newest version of every package"
	@echo "make setup      install what the book needs (the other commands do this when necessary)"
	@echo "make clean      remove everything built, but keep what is installed"

# The projects of this repository, with their extras, that each command installs. The book itself needs neither a
# browser nor the tests.
PROJECTS_book := . ./packages/coursework[tools] ./packages/notebook-pages ./packages/orientation-lab
PROJECTS_print := . ./packages/coursework[tools] ./packages/notebook-pages[print] ./packages/orientation-lab
PROJECTS_pins := . ./packages/coursework[tools] ./packages/notebook-pages[pins] ./packages/orientation-lab
PROJECTS_test := .[test] ./packages/coursework[tools,cluster,test] ./packages/notebook-pages[print,test] ./packages/orientation-lab[test]
PROJECTS_mutants := .[test] ./packages/coursework[tools,cluster,test] ./packages/notebook-pages[print,test] ./packages/orientation-lab[test,mutants]
# The other installations that each of these covers.
COVERS_pins := book
COVERS_print := book
COVERS_test := book print
COVERS_mutants := book print test
# Two pip commands at once would write into the same environment. The slow commands use all processors by themselves.
.NOTPARALLEL:

setup: $(VENV)/ready-book node_modules/ready $(VENV)/runtime/ready $(KERNEL_SETTINGS)

$(VENV)/bin/python:
	@$(PYTHON) -c "import sys; sys.exit(not (3, 11) <= sys.version_info < (3, 16) and 'The book needs Python 3.11 to 3.15; this is ' + sys.version.split()[0] + '. Name one: make PYTHON=python3.13')"
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

# Pages built with BOOK_NUMPY=_build/numpy need no other server. We compare each file with its fingerprint.
numpy: setup
	@$(RUN) -m notebook_pages.live.fetch _build/numpy

# AFTER names the chapter that the new one follows. The shell reads what you gave from its environment,
# so a title may contain quotation marks. We release the new chapter's exercises, so that the book builds.
new-chapter: setup
	@$(RUN) -m tools.new chapter "$$NAME" "$$TITLE" $(if $(AFTER),--after "$$AFTER")
	@$(RUN) -m coursework release "$$NAME" chapters

new-question: setup
	@$(RUN) -m tools.new question "$$NAME" "$$TITLE" $(if $(KIND),--kind "$$KIND")

check: $(VENV)/ready-test setup
	@$(RUN) -m pytest -q tests/test_style.py tests/test_pins.py tests/test_budget.py tests/chapters/test_chapters.py

BASE ?= main
quick: $(VENV)/ready-test book
	@git rev-parse --quiet --verify "$(BASE)^{commit}" >/dev/null || { echo "There is no commit $(BASE) here. Name another: make quick BASE=HEAD~1"; exit 1; }
	@tests=$$($(RUN) -m tools.touched $(BASE)) && echo "Tests: $$tests" && $(RUN) -m pytest -n auto -m "not long" $$tests

# Tests that are slow and rarely fail are left to `make test-rest`. `.ci/run` runs both.
test: $(VENV)/ready-test book
	@$(RUN) -m notebook_pages.browser || true
	@$(RUN) -m pytest -n auto -m "not long"

# A browser prints the PDF. Without a browser, the tests that need one are skipped.
test-rest: $(VENV)/ready-test book
	@if $(RUN) -m notebook_pages.browser; then $(RUN) -m notebook_pages.whole_book; fi
	@$(RUN) -m pytest -n auto -m long

notebooks: setup
	@$(RUN) -m notebook_pages.notebooks

release: setup
	@$(RUN) -m coursework release $(ONLY)
	@$(RUN) -m coursework selftest $(ONLY)

# Run cells, releases and doctests as other processors would (ONLY=unit-quaternions runs one notebook).
anywhere: $(VENV)/ready-test setup
	@$(RUN) -m tools.anywhere $(ONLY)

oldest: $(VENV)/ready-pins
	@$(RUN) -m uv venv --quiet --clear --python $(RUN) _build/oldest
	@$(RUN) -m uv pip install --quiet --python _build/oldest --resolution lowest-direct --editable ".[test]"
	@_build/oldest/bin/python -m pytest -q -c tests/orientation/pytest.ini tests/orientation

# For each change that survives, either a test is missing or the change has no effect (ONLY="orientation.comparison*").
mutants: $(VENV)/ready-mutants setup
	@$(VENV)/bin/mutmut run $(ONLY) && $(VENV)/bin/mutmut results

# Print each answer that differs from the stored one.
programs: setup
	@$(RUN) -m tools.programs

renew-pins: $(VENV)/ready-pins setup
	@$(RUN) -m notebook_pages.pins

benchmark: $(VENV)/ready-test setup
	@$(PIP) --requirement tools/benchmarks/peers.txt
	@$(RUN) -m tools.benchmarks

clean:
	rm -rf _build
