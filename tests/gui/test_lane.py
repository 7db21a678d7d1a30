"""The lane: one thread, of what waits the newest question of each asker wins, errors are sentences, closing does not wait."""

import math
import threading

import pytest

from lensbench.errors import InputError
from lensbench.gui.lane import PATIENCE, Lane


@pytest.fixture
def lane(qtbot):
    lane = Lane()
    lane.heard = []
    lane.answered.connect(lambda asker, answer: lane.heard.append((asker, answer)))
    lane.failed.connect(lambda asker, sentence: lane.heard.append((asker, sentence)))
    yield lane
    lane.close()
    lane.wait()


def held(lane, gate, asker="map"):
    """Keep the lane at work until the gate opens."""
    begun = threading.Event()

    def question():
        begun.set()
        gate.wait(10)
        return "held"

    lane.ask(asker, question)
    assert begun.wait(10)


def test_of_those_that_wait_only_the_newest_is_answered(lane, qtbot):
    gate, asked = threading.Event(), []
    held(lane, gate)
    for k in range(40):
        lane.ask("map", lambda k=k: asked.append(k) or k)
    with qtbot.waitSignal(lane.idle, timeout=10000):
        gate.set()
    assert asked == [39]
    assert lane.heard == [("map", "held"), ("map", 39)]


def test_an_asker_who_asks_again_keeps_his_turn(lane, qtbot):
    """Else the first of four viewports would be answered for ever while a slider is dragged, and the others never."""
    gate = threading.Event()
    held(lane, gate, "first")
    for k in range(3):
        for asker in ("second", "first"):
            lane.ask(asker, lambda k=k: k)
    with qtbot.waitSignal(lane.idle, timeout=10000):
        gate.set()
    assert lane.heard == [("first", "held"), ("second", 2), ("first", 2)]


def test_one_asker_dropped(lane, qtbot):
    gate = threading.Event()
    held(lane, gate)
    lane.ask("profile", lambda: "profile")
    lane.drop("map")
    lane.ask("map", lambda: "anew")
    with qtbot.waitSignal(lane.idle, timeout=10000):
        gate.set()
    assert lane.heard == [("profile", "profile"), ("map", "anew")]


def test_askers_do_not_displace_each_other_and_the_urgent_goes_first(lane, qtbot):
    gate = threading.Event()
    held(lane, gate, "view")
    lane.ask("map", lambda: "map")
    lane.ask("profile", lambda: "profile")
    lane.ask("probe", lambda: "probe", first=True)
    with qtbot.waitSignal(lane.idle, timeout=10000):
        gate.set()
    assert lane.heard == [("view", "held"), ("probe", "probe"), ("map", "map"), ("profile", "profile")]


def test_dropped_questions_stay_unanswered(lane, qtbot):
    gate = threading.Event()
    held(lane, gate)
    lane.ask("profile", lambda: "profile")
    with qtbot.waitSignal(lane.stopped):
        lane.stop()
    with qtbot.waitSignal(lane.idle, timeout=10000):
        gate.set()
    assert lane.heard == []


def test_errors_are_one_sentence(lane, qtbot):
    def wrong(error):
        raise error

    with qtbot.waitSignal(lane.idle, timeout=10000):
        lane.ask("map", lambda: wrong(InputError("lens.toml: radius: must not be 0")))
    with qtbot.waitSignal(lane.idle, timeout=10000):
        lane.ask("map", lambda: wrong(ZeroDivisionError("oh")))
    with qtbot.waitSignal(lane.idle, timeout=10000):
        lane.ask("map", lambda: wrong(SystemExit("gone")))
    assert lane.heard == [
        ("map", "lens.toml: radius: must not be 0"), ("map", "ZeroDivisionError: oh"), ("map", "SystemExit: gone"),
    ]  # fmt: skip


def test_all_is_computed_in_one_thread_that_is_not_ours(lane, qtbot):
    threads = []
    for asker in ("a", "b", "c"):
        lane.ask(asker, lambda: threads.append(threading.get_ident()))
    qtbot.waitUntil(lambda: len(threads) == 3, timeout=10000)
    assert len(set(threads)) == 1
    assert threads[0] != threading.get_ident()


def test_closing_while_computing_does_not_wait_and_says_nothing(qtbot):
    lane, gate, heard = Lane(), threading.Event(), []
    lane.answered.connect(lambda *answer: heard.append(answer))
    held(lane, gate)
    lane.ask("map", lambda: heard.append("later"))
    lane.close()
    assert not gate.is_set()
    gate.set()
    lane.wait()
    qtbot.wait(50)
    assert heard == []


def test_a_lane_that_is_gone_may_still_be_computing(qtbot, recwarn):
    lane, gate = Lane(), threading.Event()
    held(lane, gate)
    lane.close()
    thread = lane._thread
    lane.deleteLater()
    del lane
    qtbot.wait(20)
    gate.set()
    thread.join(10)
    assert not thread.is_alive()
    assert not [w for w in recwarn if "thread" in str(w.message).lower()]


def test_two_lanes_never_compute_at_the_same_time(lane, qtbot):
    """Kernels in parallel from two threads end the process under numba's workqueue layer."""
    other, gate, second = Lane(), threading.Event(), threading.Event()
    held(other, gate)
    other.close()
    lane.ask("map", lambda: second.set())
    qtbot.wait(100)
    assert not second.is_set()
    gate.set()
    assert second.wait(10)
    other.wait()


def test_refinement_stands_back_while_others_wait_and_while_an_answer_is_drawn(lane, qtbot):
    assert lane.haste == 0
    gate, hastes = threading.Event(), []
    lane.idle.connect(lambda: hastes.append(lane.haste))
    held(lane, gate)
    assert lane.haste == PATIENCE
    with qtbot.waitSignal(lane.idle, timeout=10000):
        gate.set()
    assert hastes == [math.inf]
    qtbot.waitUntil(lambda: lane.haste == 0, timeout=1000)
