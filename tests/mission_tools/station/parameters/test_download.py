"""The list of parameters from boats that behave badly, and from real boats over bad links."""

import math
from collections.abc import Callable, Set

import pytest
from boat_rig import Rig
from shore_rig import Shore

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.parameters import download
from mission_tools.station.parameters.download import Download, State
from mission_tools.station.parameters.parameter_table import TableSnapshot

BOAT, OWN = Address(1, 1), Address(250, 190)
REAL32, INT32 = dialect.MAV_PARAM_TYPE_REAL32, dialect.MAV_PARAM_TYPE_INT32


def value(name: str | bytes, number: float, index: int, count: int, kind: int = REAL32) -> Message:
    raw = name.encode("ascii") if isinstance(name, str) else name
    message = dialect.MAVLink_param_value_message(raw, number, kind, count, index)
    packed = message.pack(dialect.MAVLink(None))
    (heard,) = dialect.MAVLink(None).parse_buffer(packed) or []
    return heard  # type: ignore[no-any-return]


class Script:
    """A download, and what it sends. answer: what the boat does with each message."""

    def __init__(self, answer: Callable[[Message], list[Message]] = lambda _: []) -> None:
        self.sent: list[Message] = []
        self.download = Download(BOAT, self._send)
        self.now_s = 0.0
        self._answer = answer

    def _send(self, message: Message) -> None:
        self.sent.append(message)

    def run(self, seconds: float, is_wanted: bool = True) -> None:
        for _ in range(round(seconds / 0.05)):
            self.now_s += 0.05
            before = len(self.sent)
            self.download.poll(self.now_s, is_wanted)
            for message in self.sent[before:]:
                for answer in self._answer(message):
                    self.download.handle(answer, self.now_s)

    @property
    def state(self) -> State:
        return self.download.state

    def count(self, name: str) -> int:
        return sum(message.get_type() == name for message in self.sent)


def lister(
    names: list[str], lost: Set[int], deaf: Set[int] = frozenset()
) -> Callable[[Message], list[Message]]:
    """A boat that loses some entries of its list, and does not answer for the deaf ones."""

    def answer(message: Message) -> list[Message]:
        if message.get_type() == "PARAM_REQUEST_LIST":
            return [value(n, i, i, len(names)) for i, n in enumerate(names) if i not in lost]
        if message.get_type() == "PARAM_REQUEST_READ" and message.param_index not in deaf:
            return [value(names[message.param_index], message.param_index, message.param_index, len(names))]
        return []

    return answer


NAMES = [f"P_{number}" for number in range(100)]


def test_what_the_list_lost_is_asked_for_by_index_only() -> None:
    script = Script(lister(NAMES, lost={3, 40, 99}))
    script.run(4.0)
    assert script.state == "here"
    assert script.download.missing == 0
    assert {name: one.value for name, one in script.download.values.items()} == {
        name: float(number) for number, name in enumerate(NAMES)
    }
    asked = [one.param_index for one in script.sent if one.get_type() == "PARAM_REQUEST_READ"]
    assert asked == [3, 40, 99]
    assert script.count("PARAM_REQUEST_LIST") == 1


def test_repairs_go_round_at_a_bounded_rate() -> None:
    lost = set(range(0, 90, 2))
    script = Script(lister(NAMES, lost, deaf=lost))
    script.run(12.0)
    asked = [one.param_index for one in script.sent if one.get_type() == "PARAM_REQUEST_READ"]
    assert set(asked) == lost  # all of them, not the first ten again and again
    most = (12.0 - download.QUIET_S) / download.REPAIR_S * download.REPAIR_COUNT
    assert most / 2 < len(asked) <= most + download.REPAIR_COUNT


def test_a_boat_that_never_answers_for_some_has_the_others() -> None:
    script = Script(lister(NAMES, lost={7}, deaf={7}))
    script.run(25.0)
    assert (script.state, script.download.missing) == ("here", 1)
    assert len(script.download.values) == 99
    before = len(script.sent)
    script.run(30.0)
    assert len(script.sent) == before
    script.run(download.AGAIN_S)
    assert len(script.sent) > before


def test_more_than_half_missing_is_a_new_list_and_not_thousands_of_repairs() -> None:
    script = Script()
    script.run(0.1)
    script.download.handle(value("A", 1.0, 0, 500), script.now_s)
    script.run(10.0)
    assert script.count("PARAM_REQUEST_READ") == 0
    assert 2 <= script.count("PARAM_REQUEST_LIST") <= 4


def test_a_boat_that_claims_65535_parameters_is_listed_as_far_as_it_sends() -> None:
    script = Script()
    script.run(0.1)
    for index in range(5):
        script.download.handle(value(f"P{index}", 1.0, index, 65535), script.now_s)
    assert script.download.count == download.MOST
    script.run(30.0)
    assert script.state == "here"
    assert list(script.download.values) == [f"P{index}" for index in range(5)]
    assert len(script.sent) < 20


def test_endless_new_names_cost_bounded_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(download, "MOST", 100)
    script = Script()
    script.run(0.1)
    for index in range(120):
        script.download.handle(value(f"N{index}", 1.0, 0xFFFF, 65535), script.now_s)
    assert len(script.download.values) == download.MOST
    script.download.handle(value("N7", 2.0, 0xFFFF, 65535), script.now_s)
    assert script.download.values["N7"].value == 2.0


def test_a_count_that_changes_begins_the_list_anew_but_not_all_the_time() -> None:
    script = Script(lister(NAMES, lost=set()))
    script.run(2.0)
    assert script.state == "here"
    script.now_s += download.ANEW_S
    script.download.handle(value("P_0", 5.0, 0, 101), script.now_s)
    assert (script.state, script.download.count) == ("loading", 101)
    for number in range(200):
        script.download.handle(value("P_0", 5.0, 0, 50 + number), script.now_s)
    assert script.download.count == 101
    version = script.download.version
    script.download.restart()
    assert (script.state, script.download.version, script.download.missing) == ("waiting", version + 1, 0)


@pytest.mark.parametrize("name", [b"\x01\x02", b"A\nB", b"", b"A B", b"\xc3\xa4", b"\x7f"])
def test_a_name_that_cannot_be_shown_is_left_out_and_does_not_stop_the_list(name: bytes) -> None:
    script = Script()
    script.run(0.1)
    script.download.handle(value(name, 1.0, 0, 2), script.now_s)
    script.download.handle(value("GOOD", 1.0, 1, 2), script.now_s)
    assert script.state == "here"
    assert list(script.download.values) == ["GOOD"]


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("kind", [REAL32, INT32])
def test_what_is_no_number_is_known_as_none(number: float, kind: int) -> None:
    script = Script()
    script.download.handle(value("ODD", number, 0, 1, kind), 1.0)
    assert script.download.values["ODD"].number() is None


def test_whole_numbers_are_cast_by_ardupilot_and_bytes_by_px4() -> None:
    script = Script()
    script.download.handle(value("INT", -7.0, 0, 1, INT32), 1.0)
    assert script.download.values["INT"].number() == -7
    script.download.is_bytewise = True
    raw = dialect.struct.unpack("<f", dialect.struct.pack("<i", 1_000_001))[0]
    script.download.handle(value("INT", raw, 0, 1, INT32), 1.0)
    assert script.download.values["INT"].number() == 1_000_001


def test_a_download_that_is_no_longer_wanted_rests_and_then_goes_on() -> None:
    script = Script(lister(NAMES, lost=set(range(10)), deaf=set()))
    script.run(20.0, is_wanted=False)
    assert script.sent == []
    script.run(0.1)
    assert script.download.missing == 10
    script.run(60.0, is_wanted=False)
    assert len(script.sent) == 1
    script.run(3.0)
    assert script.state == "here"
    assert script.count("PARAM_REQUEST_LIST") == 1


# Real boats


def snapshot(shore: Shore, boat: int = 1) -> TableSnapshot:
    return shore.boat(boat).parameters.snapshot()


def until_here(shore: Shore, limit_s: float, boat: int = 1) -> TableSnapshot:
    shore.until(lambda: shore.boats.get(boat) is not None, 30.0)
    shore.until(lambda: snapshot(shore, boat).state == "here", limit_s)
    return snapshot(shore, boat)


def on_board(rig: Rig) -> dict[str, float]:
    parameters = rig.boat.parameters
    return {row.name: parameters.value(row) for row in parameters.rows}


def known(shore: Shore) -> dict[str, float | None]:
    return {name: one.value for name, one in snapshot(shore).values.items()}


def test_all_parameters_of_a_real_boat_come_over_a_lossy_link() -> None:
    rig = Rig()
    shore = Shore(rig, loss=0.4, seed=3)
    seen = until_here(shore, 120.0)
    assert seen.missing == 0
    assert known(shore) == on_board(rig)
