"""The document: every edit can be undone, rows of edits as one, errors change nothing."""

from dataclasses import replace
from pathlib import Path

import pytest

from lensbench.errors import InputError
from lensbench.gui.document import MOST_STEPS, Document
from lensbench.session import Workbench

SAMPLES = Path(__file__).parents[2] / "sample_lenses"


@pytest.fixture
def document(qtbot):
    return Document()


def split(count):
    return lambda bench: replace(bench, split=count)


def test_changes_are_told_with_old_and_new(document):
    heard = []
    document.changed.connect(lambda *pair: heard.append(pair))
    before = document.workbench
    document.edit("Split", split(2))
    assert heard == [(before, document.workbench)]
    document.edit("Nothing", lambda bench: bench)
    assert len(heard) == 1


def test_undo_and_redo_give_back_the_very_workbench(document):
    first = document.workbench
    document.edit("Two", split(2))
    second = document.workbench
    document.edit("One", split(1))
    document.undo()
    assert document.workbench is second
    assert (document.undo_name, document.redo_name) == ("Two", "One")
    document.undo()
    document.undo()
    assert document.workbench is first
    document.redo()
    document.edit("Four", split(4))
    assert document.redo_name == ""


def test_a_row_of_edits_is_one_step(document):
    first = document.workbench
    for turn in range(5):
        document.edit("Turn", lambda bench, turn=turn: replace(bench, head_turn=turn + 1.0), row="turn")
    document.rest()
    document.edit("Turn", lambda bench: replace(bench, head_turn=9.0), row="turn")
    document.undo()
    assert document.workbench.head_turn == 5.0
    document.undo()
    assert document.workbench is first


def test_an_edit_that_fails_changes_nothing(document):
    before = document.workbench
    with pytest.raises(InputError):
        document.edit("Open", lambda bench: bench.with_lens(SAMPLES / "nothing.toml"))
    assert document.workbench is before
    assert not document.undo_name


def test_modified_knows_what_is_saved(document):
    assert not document.modified
    document.edit("Two", split(2))
    assert document.modified
    document.saved()
    document.undo()
    assert document.modified
    document.redo()
    assert not document.modified
    document.open(Workbench())
    assert not document.modified
    assert not document.undo_name


def test_memory_of_steps_is_bounded(document):
    for k in range(MOST_STEPS + 20):
        document.edit("Turn", lambda bench, k=k: replace(bench, head_turn=float(k + 1)))
    for _ in range(MOST_STEPS + 20):
        document.undo()
    assert document.workbench.head_turn == 20.0
