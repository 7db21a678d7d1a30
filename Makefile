# make report: a full lens report in reports/ · make gallery: designs side by side · make test: everything that must hold · make bench: measured speed
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
GL_PACKAGES := libegl1 libgl1 libgl1-mesa-dri libopengl0
WINDOW_PACKAGES := $(GL_PACKAGES) xvfb libdbus-1-3 libfontconfig1 libglib2.0-0 libxcb-cursor0 libxcb-icccm4 libxcb-image0 \
	libxcb-keysyms1 libxcb-randr0 libxcb-render-util0 libxcb-shape0 libxcb-xfixes0 libxcb-xkb1 libxkbcommon-x11-0

.PHONY: report gallery test bench check graphics window browser clean

report: $(VENV)/.report graphics
	$(BIN)/lensbench report sample_lenses/regular_R.toml --wearer sample_lenses/presbyope_60.toml -o reports/regular_R

DESIGNS := $(patsubst %,sample_lenses/%_R.toml,regular wide_near wide_far occupational)
gallery: $(VENV)/.report graphics
	$(BIN)/lensbench gallery $(DESIGNS) -o reports/gallery --small docs/gallery.png
	$(BIN)/lensbench scenes -o docs/scenes.png

test: check browser
	$(BIN)/python -m pytest -n auto

check: $(VENV)/.dev window
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

bench: $(VENV)/.dev window
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

# $(call needs,FILES,PACKAGES,WHY): Debian packages, if one of these libraries or programs is missing on a Linux machine.
define needs
	@if [ "$$(uname)" != Linux ]; then exit 0; fi; missing=""; \
	for file in $(1); do ldconfig -p | grep -q "$$file" || command -v "$$file" >/dev/null || missing="$$missing $$file"; done; \
	if [ -z "$$missing" ]; then exit 0; \
	elif [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
		apt-get update -qq && apt-get install -y -qq --no-install-recommends $(2); \
	else \
		echo "$(3), and this machine lacks:$$missing. On Debian or Ubuntu:"; echo "    sudo apt-get install $(2)"; exit 1; \
	fi
endef

# Pictures are drawn off screen by OpenGL; Mesa's software driver is enough.
graphics:
	$(call needs,libEGL.so.1,$(GL_PACKAGES),LensBench draws with OpenGL)

# The window's tests open it on a virtual screen.
window:
	$(call needs,libEGL.so.1 Xvfb libxcb-cursor.so.0 libxcb-icccm.so.4 libxkbcommon-x11.so.0,$(WINDOW_PACKAGES),The window needs Qt)

# The printed report is tested in a headless Chromium; without one those tests are skipped.
browser:
	@for name in chromium chromium-browser google-chrome; do ! command -v $$name >/dev/null || exit 0; done; \
	if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
		apt-get update -qq && apt-get install -y -qq --no-install-recommends chromium && exit 0; \
	fi; echo "Without Chromium the tests of the printed report are skipped. On Debian: sudo apt-get install chromium"

clean:
	rm -rf $(VENV) build dist .pytest_cache .mypy_cache .ruff_cache
