"""The lens report: results and pictures in one self-contained HTML file, PNGs and results.json."""
