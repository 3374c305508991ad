"""From a station's command down to the pins: the boat in lockstep, its payload on recorded mock pins."""

from collections.abc import Iterator

import gpiozero
import pytest
from boat_rig import Rig, scenario
from gpiozero.pins.mock import MockFactory, MockPin
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.lines import opened

from companion.app.hardware import begin_payload
from companion.boat import TICK_S
from companion.mavlink.dialect import dialect

RELAY, HORN, OUT, IN = 17, 27, 22, 26
HORN_S = 0.6
PAYLOAD = f"""vehicle.payload=[
{{kind="relay", number=0, pin={RELAY}}},
{{kind="horn", number=1, pin={HORN}, max_on_s={HORN_S}}},
{{kind="winch", number=1, out_pin={OUT}, in_pin={IN}, line_m=0.6, speed_m_s=0.5}},
]""".replace("\n", " ")


class PinnedRig(Rig):
    """A boat with its payload on mock pins. history: (time, pin, level) of every change."""

    def __init__(self) -> None:
        self.history: list[tuple[float, int, int]] = []
        self.is_ready = False
        rig = self

        class RecordedPin(MockPin):  # type: ignore[misc]
            def _change_state(self, value: float) -> bool:
                has_changed: bool = super()._change_state(value)
                if has_changed:
                    rig.history.append(
                        (rig.now_s if rig.is_ready else 0.0, int(self.info.name[4:]), int(value))
                    )
                return has_changed

        self.factory = MockFactory(pin_class=RecordedPin)
        before, gpiozero.Device.pin_factory = gpiozero.Device.pin_factory, self.factory
        try:
            super().__init__(
                "open", PAYLOAD, payload=begin_payload(scenario("open", PAYLOAD).vehicle, opened)
            )
        finally:
            gpiozero.Device.pin_factory = before
        self.is_ready = True
        self.run(0.2)

    def level(self, pin: int) -> int:
        return int(self.factory.pin(pin).state)

    def levels(self) -> list[int]:
        return [self.level(pin) for pin in (RELAY, HORN, OUT, IN)]

    def check(self) -> None:
        """What holds at every change of a pin."""
        level = dict.fromkeys((RELAY, HORN, OUT, IN), 0)
        horn_s = 0.0
        for time_s, pin, value in self.history:
            level[pin] = value
            assert not (level[OUT] and level[IN]), "both inputs of the winch"
            if pin == HORN and value:
                horn_s = time_s
            elif pin == HORN:
                assert time_s - horn_s <= HORN_S + 1.5 * TICK_S, "the horn went on"


@pytest.fixture
def rig() -> Iterator[PinnedRig]:
    rig = PinnedRig()
    yield rig
    rig.boat.close()
    rig.factory.reset()


def test_all_pins_are_off_once_the_boat_has_closed(rig: PinnedRig) -> None:
    rig.ask(dialect.MAV_CMD_DO_SET_RELAY, 0, 1)
    rig.ask(dialect.MAV_CMD_DO_SET_RELAY, 1, 1)
    rig.ask(dialect.MAV_CMD_DO_WINCH, 1, 2, 0, 0.5)
    rig.run(0.2)
    assert rig.levels() == [1, 1, 1, 0]
    rig.boat.close()
    last = {pin: value for _, pin, value in rig.history}
    assert last == {RELAY: 0, HORN: 0, OUT: 0}
    assert {str(rig.factory.pin(pin).function) for pin in (RELAY, HORN, OUT, IN)} == {"input"}


COMMANDS = st.one_of(
    st.tuples(st.just(dialect.MAV_CMD_DO_SET_RELAY), st.sampled_from([0, 1]), st.sampled_from([0, 1])),
    st.tuples(st.just(dialect.MAV_CMD_DO_REPEAT_RELAY), st.sampled_from([0, 1]), st.integers(1, 4),
              st.sampled_from([0.1, 0.3, 1.2])),
    st.tuples(st.just(dialect.MAV_CMD_DO_WINCH), st.just(1), st.sampled_from([0, 1, 2, 3, 6]),
              st.sampled_from([-0.6, 0.1, 0.6]), st.sampled_from([-0.5, 0.0, 0.5])),
)  # fmt: skip


@settings(max_examples=6)  # each with a boat of its own
@given(st.lists(st.tuples(COMMANDS, st.sampled_from([0.0, 0.06, 0.5])), max_size=8))
def test_whatever_the_commands_never_both_inputs_and_no_endless_horn(
    steps: list[tuple[tuple[float, ...], float]],
) -> None:
    rig = PinnedRig()
    for (number, *params), seconds in steps:
        rig.peer.command(int(number), *params)
        rig.receive()
        rig.run(seconds)
    rig.run(4.9)  # four repetitions take 4.8 s
    rig.check()
    assert rig.levels()[1:] == [0, 0, 0]  # all motions and the horn have ended
    rig.boat.close()
    rig.check()
    rig.factory.reset()
    assert rig.boat.endpoint.faults == 0
