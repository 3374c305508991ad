"""From any actions down to the pins: the payload of a boat on recorded mock pins."""

import gpiozero
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.lines import opened
from twins.pins import PinBoard

from companion.app.hardware import begin_payload
from companion.boat import TICK_S
from companion.config.boat_config import decode_config
from companion.payload.actions import MoveWinch, RepeatRelay, SetRelay, UnitAction, WinchMotion
from companion.payload.payloads import Payloads

PINS = RELAY, HORN, OUT, IN = 17, 27, 22, 26
HORN_S = 0.6
CONFIG = decode_config(
    {
        "payload": [
            {"kind": "relay", "number": 0, "pin": RELAY},
            {"kind": "horn", "number": 1, "pin": HORN, "max_on_s": HORN_S},
            {"kind": "winch", "out_pin": OUT, "in_pin": IN, "line_m": 0.6, "speed_m_s": 0.5},
        ]
    },
    "test",
)


class Aboard:
    def __init__(self) -> None:
        self.board = PinBoard()
        before, gpiozero.Device.pin_factory = gpiozero.Device.pin_factory, self.board.factory
        try:
            self.parts = begin_payload(CONFIG, opened)
        finally:
            gpiozero.Device.pin_factory = before
        self.units = Payloads(CONFIG.payload, self.parts)
        self.run(0.2)

    def do(self, *actions: UnitAction) -> None:
        for action in actions:
            assert self.units.perform(action, self.board.clock()) == ""

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / TICK_S)):
            self.board.clock.advance(TICK_S)
            self.units.tick(self.board.clock(), is_armed=False, is_operator_lost=False)

    def levels(self) -> list[int]:
        return [int(self.board.pin(pin).state) for pin in PINS]

    def check(self) -> None:
        """What holds at every change of a pin."""
        level = dict.fromkeys(PINS, 0.0)
        horn_s = 0.0
        for time_s, pin, value in self.board.history:
            level[pin] = value
            assert not (level[OUT] and level[IN]), "both inputs of the winch"
            if pin == HORN and value:
                horn_s = time_s
            elif pin == HORN:
                assert time_s - horn_s <= HORN_S + 1.5 * TICK_S, "the horn went on"


def test_all_pins_are_off_once_the_payload_has_closed() -> None:
    aboard = Aboard()
    aboard.do(SetRelay(0, True), SetRelay(1, True), MoveWinch(1, WinchMotion.RATE, 0.0, 0.5))
    assert aboard.levels() == [1, 1, 1, 0]
    aboard.parts.close()
    last = {pin: value for _, pin, value in aboard.board.history}
    assert last == {RELAY: 0, HORN: 0, OUT: 0}
    assert {str(aboard.board.pin(pin).function) for pin in PINS} == {"input"}
    aboard.board.factory.reset()


ACTIONS: st.SearchStrategy[UnitAction] = st.one_of(
    st.builds(SetRelay, st.sampled_from([0, 1]), st.booleans()),
    st.builds(RepeatRelay, st.sampled_from([0, 1]), st.integers(1, 4), st.sampled_from([0.1, 0.3, 1.2])),
    st.builds(MoveWinch, st.just(1), st.sampled_from(WinchMotion), st.sampled_from([-0.6, 0.1, 0.6]),
              st.sampled_from([-0.5, 0.0, 0.5])),
)  # fmt: skip


@settings(max_examples=15)  # each with pins of its own
@given(st.lists(st.tuples(ACTIONS, st.sampled_from([0.0, 0.06, 0.5])), max_size=8))
def test_whatever_the_commands_never_both_inputs_and_no_endless_horn(
    steps: list[tuple[UnitAction, float]],
) -> None:
    aboard = Aboard()
    for action, seconds in steps:
        aboard.do(action)
        aboard.run(seconds)
    aboard.run(4.9)  # four repetitions take 4.8 s
    aboard.check()
    assert aboard.levels()[1:] == [0, 0, 0]  # all motions and the horn have ended
    aboard.parts.close()
    aboard.check()
    aboard.board.factory.reset()
