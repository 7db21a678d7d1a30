"""Measured speed: ratios of two things in one run, medians of several rounds. Run with `make bench`."""
