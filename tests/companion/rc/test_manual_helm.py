"""Several stations with sticks: one has the helm, the others are ignored and told so once."""

import pytest
from boat_rig import BOAT, OK, Peer, Rig

from companion.core.requests import ManualControl
from companion.mavlink.address import Address
from companion.mavlink.dialect import dialect

MAVPROXY = Address(255, 230)


@pytest.fixture
def rig() -> Rig:
    rig = Rig().ready()
    assert rig.set_mode(0) == OK
    assert rig.arm() == OK
    return rig


def push(rig: Rig, peer: Peer, throttle: int) -> ManualControl:
    peer.send(dialect.MAVLink_manual_control_message(1, 0, 0, throttle, 0, 0))
    rig.receive()
    return rig.boat.vehicle.manual_input.latest


def test_the_first_hand_has_the_helm_and_the_second_is_told_once(rig: Rig) -> None:
    other = rig.connect(MAVPROXY)
    rig.receive()
    for _ in range(10):
        assert push(rig, rig.peer, 500).throttle == 0.5
        assert push(rig, other, -500).throttle == 0.5
        rig.run(0.2)
    assert [text for text in other.texts if "Helm" in text] == [
        "Helm: 255/190 has it, your sticks are ignored"
    ]
    assert not any("Helm" in text for text in rig.peer.texts)


def test_free_manual_control_can_be_taken_over_and_is_announced(rig: Rig) -> None:
    other = rig.connect(MAVPROXY)
    push(rig, rig.peer, 500)
    rig.run(rig.config.failsafe.manual_timeout_s + 0.1)
    assert push(rig, other, -500).throttle == -0.5
    said = "Helm: 255/230 took over from 255/190"
    assert said in rig.peer.texts
    assert said in other.texts
    assert push(rig, rig.peer, 500).throttle == -0.5


def test_an_override_released_lets_go_at_once(rig: Rig) -> None:
    other = rig.connect(MAVPROXY)
    for steering, throttle in ((1500, 1800), (0, 0)):
        rig.peer.send(
            dialect.MAVLink_rc_channels_override_message(*BOAT, steering, 0, throttle, 0, 0, 0, 0, 0)
        )
    rig.receive()
    assert push(rig, other, 300).throttle == 0.3
