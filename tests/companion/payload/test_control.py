"""The payload's place in the tick: what the mission asks for, what the operator hears, what the log gets."""

import pytest
from boat_rig import FRAME, GOOD_FIX, nav_at
from payload_rig import PayloadRig

from companion.config.boat_config import decode_config
from companion.core.geo import Point
from companion.core.status_text import Severity
from companion.payload.actions import PayloadAction, RunCommand, SetRelay, StartCapture, StopCapture
from companion.vehicle.payload_control import PayloadControl
from companion.vehicle.vehicle import Vehicle
from sitl.world.payload import SimPayload

TICK_S = 0.02
CONFIG = decode_config(
    {
        "payload": [
            {"kind": "relay", "number": 0, "pin": 17, "on_disarm": "off", "on_link_loss": "on"},
            {"kind": "command", "number": 7, "run": ["/bin/true"]},
        ],
        "camera": {"capture": ["/bin/true"]},
        "mission": {"absent_payload": "skip"},
    },
    "test",
)


class Rig:
    """A payload over recorded outputs, aboard a vehicle whose mission gives `actions`."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.vehicle = Vehicle(CONFIG)
        self.sim = SimPayload(CONFIG)
        self.control = PayloadControl(CONFIG, self.sim.parts, self.vehicle)
        self.actions: list[PayloadAction] = []
        self.now_s = 0.0
        monkeypatch.setattr(self.vehicle.progress, "take_actions", self._take_actions)

    def _take_actions(self) -> list[PayloadAction]:
        actions, self.actions = self.actions, []
        return actions

    def tick(self, *actions: PayloadAction) -> list[tuple[int, str]]:
        """One tick in which the mission asks for these. What the operator is told."""
        self.actions += actions
        self.now_s += TICK_S
        self.sim.step(self.now_s)
        self.control.tick(self.now_s)
        return [(severity, text) for severity, text in self.vehicle.take_status_texts()]

    @property
    def relay(self) -> float:
        return self.sim.outputs[0].value


@pytest.fixture
def rig(monkeypatch: pytest.MonkeyPatch) -> Rig:
    rig = Rig(monkeypatch)
    rig.tick()  # enters the states of the start
    rig.tick()
    return rig


def test_what_cannot_be_done_now_is_told_as_the_missions(rig: Rig) -> None:
    assert rig.control.perform(RunCommand(7), rig.now_s) == ""
    rig.tick()
    assert (Severity.WARNING, "Mission: command 7: still running") in rig.tick(RunCommand(7))
    assert rig.control.perform(RunCommand(7), rig.now_s) == "command 7: still running"


def test_an_image_is_news_and_has_the_boats_place(rig: Rig) -> None:
    assert rig.control.position is None
    rig.vehicle.update_state(nav_at(30.0, 40.0), None, GOOD_FIX, None, 1.0)
    assert rig.control.position is None, "without a frame"
    rig.vehicle.update_state(None, FRAME, GOOD_FIX, None, 1.0)
    assert rig.control.position is None, "without an estimate"
    rig.vehicle.update_state(nav_at(30.0, 40.0), FRAME, GOOD_FIX, None, 1.0)
    assert rig.control.perform(StartCapture(), rig.now_s) == ""
    assert rig.control.perform(StartCapture(), rig.now_s) == ""
    told = [rig.tick() for _ in range(200) if not rig.control.images]
    (image,) = rig.control.images
    assert rig.control.has_news
    assert not rig.control.written
    assert image.position is not None
    assert FRAME.to_local(image.position) == pytest.approx(Point(30.0, 40.0), abs=0.01)
    assert not any(told), "a good image is not told"
    rig.tick()
    assert rig.control.perform(StopCapture(), rig.now_s) == ""


def test_disarming_enters_the_safe_states(rig: Rig) -> None:
    rig.tick(SetRelay(0, True))
    rig.vehicle.armed = True
    rig.tick()
    assert rig.relay == 1.0
    rig.vehicle.armed = False
    rig.tick()
    assert rig.relay == 0.0


def test_the_loss_of_the_operator_enters_its_states(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    assert rig.relay == 0.0
    monkeypatch.setattr(
        rig.vehicle.failsafes, "is_active", lambda condition: condition.name == "OPERATOR_LOST"
    )
    rig.tick()
    assert rig.relay == 1.0


def test_the_payload_closes_with_the_boat() -> None:
    rig = PayloadRig()
    rig.boat.close()
    assert all(output.is_closed for output in rig.sim.outputs.values())
