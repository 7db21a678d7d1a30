# make report: a full lens report in reports/ · make gallery: designs side by side · make test: everything that must hold · make bench: measured speed
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
GL_PACKAGES := libegl1 libgl1 libgl1-mesa-dri libopengl0

.PHONY: report gallery test bench check graphics clean

report: $(VENV)/.report graphics
	$(BIN)/lensbench report sample_lenses/regular_R.toml --wearer sample_lenses/presbyope_60.toml -o reports/regular_R

DESIGNS := $(patsubst %,sample_lenses/%_R.toml,regular wide_near wide_far occupational)
gallery: $(VENV)/.report graphics
	$(BIN)/lensbench gallery $(DESIGNS) -o reports/gallery --small docs/gallery.png
	$(BIN)/lensbench scenes -o docs/scenes.png

test: check
	$(BIN)/python -m pytest -n auto

check: $(VENV)/.dev graphics
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

bench: $(VENV)/.dev graphics
	$(BIN)/python -m benchmarks

$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "LensBench needs Python 3.11 or newer; this is " + sys.version)'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip

$(VENV)/.report: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --editable ".[report]"
	@touch $@

$(VENV)/.dev: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --editable ".[dev]"
	@touch $@

# Pictures are drawn off screen by OpenGL; Mesa's software driver is enough.
graphics:
	@if [ "$$(uname)" != Linux ] || ldconfig -p | grep -q libEGL.so.1; then exit 0; \
	elif [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
		apt-get update -qq && apt-get install -y -qq --no-install-recommends $(GL_PACKAGES); \
	else \
		echo "LensBench draws with OpenGL, and libEGL.so.1 is not installed. On Debian or Ubuntu:"; \
		echo "    sudo apt-get install $(GL_PACKAGES)"; exit 1; \
	fi

clean:
	rm -rf $(VENV) build dist .pytest_cache .mypy_cache .ruff_cache
