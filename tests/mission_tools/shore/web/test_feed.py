"""Differences, slow readers and repeated ids, without a socket."""

import json
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from mission_tools.shore.web.feed import LOST_S, QUIET_S, UNACKNOWLEDGED, Feed, Viewer, difference
from mission_tools.shore.web.request_log import KEPT_S, MOST_KEPT, Reply, RequestLog
from mission_tools.station.messages import Answer, BoatName, Hello, PageRequest, Place, Snapshot

LEAVES = st.one_of(
    st.booleans(), st.integers(-3, 3), st.text(max_size=2), st.lists(st.integers(0, 2), max_size=2)
)
TREES = st.recursive(
    st.dictionaries(st.sampled_from("abc"), LEAVES),
    lambda inner: st.dictionaries(st.sampled_from("abc"), inner | LEAVES),
)
GREETING = Hello(role="viewer", boats=[BoatName(id=1)])


def merged(whole: Any, patch: Any) -> Any:  # noqa: ANN401 (JSON)
    """RFC 7396, as its text has it."""
    if not isinstance(patch, dict):
        return patch
    result = dict(whole) if isinstance(whole, dict) else {}
    for name, value in patch.items():
        if value is None:
            result.pop(name, None)
        else:
            result[name] = merged(result.get(name), value)
    return result


@given(TREES, TREES)
def test_a_patch_makes_the_new_of_the_old(old: dict[str, Any], new: dict[str, Any]) -> None:
    assert merged(old, difference(old, new)) == new


def reader(feed: Feed) -> Viewer:
    viewer = Viewer(feed, 0.0)
    viewer.greet(GREETING)
    return viewer


def states(texts: list[str]) -> list[Any]:
    return [one["patch"] for one in map(json.loads, texts) if one["type"] == "state"]


def test_a_slow_reader_gets_the_newest_and_no_queue() -> None:
    feed = Feed(1)
    viewer = reader(feed)
    shown: Any = {}
    sent = 0
    for number in range(500):
        feed.update(Snapshot(boat=1, speed_m_s=float(number), place=Place(lat=number / 10, lon=0.0)))
        for patch in states(viewer.take(number * 0.2)[0]):
            shown = merged(shown, patch)
            sent += 1
    assert sent == UNACKNOWLEDGED
    assert shown["speed_m_s"] == UNACKNOWLEDGED - 1
    viewer.on_pong(100.0)
    (patch,) = states(viewer.take(100.0)[0])
    assert merged(shown, patch) == feed.tree


def test_a_reader_without_a_pong_is_lost_and_a_slow_one_is_not() -> None:
    feed = Feed(1)
    viewer = reader(feed)
    feed.update(Snapshot(boat=1))
    viewer.take(0.0)
    assert not viewer.is_lost(LOST_S)
    assert viewer.is_lost(LOST_S + 1.0)
    viewer.on_pong(LOST_S)
    assert not viewer.is_lost(10.0 * LOST_S)


def test_something_is_sent_while_nothing_changes() -> None:
    feed = Feed(1)
    viewer = reader(feed)
    assert len(viewer.take(0.0)[0]) == 1
    assert viewer.take(QUIET_S - 0.1)[0] == []
    assert [json.loads(text)["type"] for text in viewer.take(QUIET_S)[0]] == ["hello"]
    feed.update(Snapshot(boat=1))
    viewer.take(3.0)
    assert states(viewer.take(3.0 + QUIET_S)[0]) == [{}]


class Doer:
    """Keeps what it was told to do."""

    def __init__(self) -> None:
        self.done: list[str] = []
        self.replies: list[Reply] = []

    def __call__(self, request: PageRequest, reply: Reply) -> None:
        self.done.append(request.id)
        self.replies.append(reply)


def ask(ident: str) -> PageRequest:
    return PageRequest(id=ident, boat=1, what="hold")


def test_a_repeated_id_is_done_once_and_answered_alike() -> None:
    request_log, do = RequestLog(), Doer()
    first: list[Answer] = []
    again: list[Answer] = []
    later: list[Answer] = []
    request_log.submit(ask("a"), first.append, do, 0.0)
    request_log.submit(ask("a"), again.append, do, 1.0)
    do.replies[0](Answer(id="a", ok=True, text="Holding."))
    do.replies[0](Answer(id="a", ok=False, text="A second answer."))
    request_log.submit(ask("a"), later.append, do, KEPT_S)
    assert do.done == ["a"]
    assert first == again == later
    assert [one.text for one in first] == ["Holding."]


def test_ids_are_kept_for_a_time_and_a_number() -> None:
    request_log, do = RequestLog(), Doer()
    request_log.submit(ask("a"), lambda _: None, do, 0.0)
    request_log.submit(ask("a"), lambda _: None, do, KEPT_S + 1.0)
    assert do.done == ["a", "a"]
    for number in range(3 * MOST_KEPT):
        request_log.submit(ask(str(number)), lambda _: None, do, KEPT_S + 2.0)
    assert len(request_log._entries) <= MOST_KEPT


def test_a_closed_socket_gets_no_answer() -> None:
    request_log, do = RequestLog(), Doer()
    heard: list[Answer] = []
    reply = heard.append
    request_log.submit(ask("a"), reply, do, 0.0)
    request_log.leave(reply)
    do.replies[0](Answer(id="a", ok=True, text="Holding."))
    assert heard == []
