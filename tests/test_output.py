"""Files are written whole or not at all, and numbers become strict JSON."""

import json

import numpy as np
import pytest

from lensbench import output


def test_a_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "a.txt"
    output.write_file(path, "old")

    def fail(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(output.os, "replace", fail)
    with pytest.raises(output.InputError, match="No space left"):
        output.write_file(path, "new")
    assert path.read_text(encoding="utf-8") == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_json_of_arrays_nan_and_infinity():
    text = output.to_json({"a": np.array([1.0, np.nan]), "b": np.inf, "c": (np.int8(3), 0.123456789)})
    assert json.loads(text) == {"a": [1.0, None], "b": "inf", "c": [3, 0.1234568]}
