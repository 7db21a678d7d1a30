"""Report and comparison in a browser: on a narrow screen and on paper no column is hidden and no cell is cut."""

import json
import re
import shutil
import subprocess
import unicodedata
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import lensbench as lb
from lensbench.compare import compare
from lensbench.report import build, comparison
from lensbench.report.html import picture_of
from lensbench.scenes.builtin import load_scene
from lensbench.workbench import assumed_wearer

SAMPLES = Path(__file__).parent.parent / "sample_lenses"
NAMES = ("chromium", "chromium-browser", "google-chrome")
BROWSER = next((found for found in map(shutil.which, NAMES) if found), None)
OPTIONS = (
    "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync --no-pdf-header-footer --window-size=1280,900"
)
MEASURE = """<script>
const hidden = [];
for (const cell of document.querySelectorAll("td, th")) {
  const box = cell.getBoundingClientRect();
  let right = document.documentElement.clientWidth;
  for (let outer = cell; outer; outer = outer.parentElement) {
    const frame = outer.getBoundingClientRect();
    if (outer !== cell && getComputedStyle(outer).overflowX !== "visible") right = Math.min(right, frame.right);
  }
  if (box.right > right + 0.5 || cell.scrollWidth > cell.clientWidth + 1) hidden.push(cell.innerText);
}
document.body.innerHTML = "<pre>" + JSON.stringify([document.documentElement.clientWidth, hidden]) + "</pre>";
</script>"""

pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium; Debian: apt-get install chromium")


class Pictures(dict):
    """One picture under every name."""

    def __missing__(self, name):
        return picture_of(name, name, np.full((700, 900, 3), 200, dtype=np.uint8))


def report_page():
    lens = lb.load_lens(SAMPLES / "wide_near_R.toml")
    wearer = assumed_wearer(lens)
    findings = build.find(lens, wearer, build.Terms(), load_scene("room"))
    pictures = Pictures()
    pictures["defocus_inf"] = pictures["spots"] = pictures["any"]
    return build.page(lens, wearer, findings, pictures)


def comparison_page():
    lenses = [lb.load_lens(SAMPLES / f"{name}_R.toml") for name in ("regular", "wide_near", "wide_far", "occupational")]
    wearer = assumed_wearer(lenses[0])
    return comparison.comparison_page(compare(lenses, wearer), wearer, Pictures())


@pytest.fixture(scope="module", params=[report_page, comparison_page])
def page(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "index.html"
    path.write_text(request.param(), encoding="utf-8")
    return path


def browse(path, *options):
    """Standard output of the browser that opens a page, with a profile of its own."""
    profile = path.parent / "profile"
    command = [BROWSER, *OPTIONS.split(), f"--user-data-dir={profile}", *options, path.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout


def test_no_column_is_hidden_on_a_screen_of_1280_pixels(page):
    measured = page.with_name("measured.html")
    measured.write_text(page.read_text(encoding="utf-8").replace("</body>", MEASURE + "</body>"), encoding="utf-8")
    found = re.search(r"<pre>(.*?)</pre>", browse(measured, "--dump-dom"), re.DOTALL)
    width, hidden = json.loads(found[1])
    assert 1200 < width <= 1280
    assert hidden == []


class Rows(HTMLParser):
    """The texts of the cells of every row of every table."""

    def __init__(self):
        super().__init__()
        self.rows, self.inside = [], False

    def handle_starttag(self, tag, attrs):
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
            self.inside = True

    def handle_endtag(self, tag):
        self.inside = self.inside and tag not in ("td", "th")

    def handle_data(self, data):
        if self.inside:
            self.rows[-1][-1] += data


def bare(text):
    """Text without blanks and ligatures."""
    return "".join(unicodedata.normalize("NFKC", text).split())


def test_every_row_of_every_table_is_on_paper(page):
    pypdf = pytest.importorskip("pypdf")
    path = page.with_suffix(".pdf")
    browse(page, f"--print-to-pdf={path}")
    sheets = pypdf.PdfReader(path).pages
    assert {tuple(round(float(side)) for side in sheet.mediabox[2:]) for sheet in sheets} == {(595, 842)}
    printed = [bare(sheet.extract_text()) for sheet in sheets]
    rows = Rows()
    rows.feed(page.read_text(encoding="utf-8"))
    assert len(rows.rows) > 20
    lost = [row for row in rows.rows if not any(bare("".join(row)) in text for text in printed)]
    assert lost == []
