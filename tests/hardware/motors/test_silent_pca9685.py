"""The bus of a PCA9685 fails under way: the outputs stop, or the operator is told to switch the boat off."""

from pathlib import Path

import pytest
from boat_rig import DENIED, FAILED
from driven_boat import DrivenBoat, EscTwin
from twins.pulses import Pca9685Twin

from companion.mavlink.dialect import dialect

LOST = 10**9  # transfers


def under_way(driver: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> tuple[DrivenBoat, Pca9685Twin]:
    boat = DrivenBoat(driver, monkeypatch, tmp_path)
    boat.drive()
    assert isinstance(boat.twin, EscTwin)
    assert boat.twin.chip is not None
    return boat, boat.twin.chip


def test_the_outputs_are_off_at_once_and_the_boat_keeps_its_links(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    boat, chip = under_way("esc pca9685", monkeypatch, tmp_path)
    chip.lost = LOST
    boat.run(0.1)
    assert not boat.twin.is_driving
    boat.rig.peer.forget()
    boat.run(10.0)
    assert not boat.rig.boat.vehicle.armed
    assert len(boat.rig.peer.said("HEARTBEAT")) >= 9
    assert not [text for text in boat.rig.peer.texts if "switch the boat off" in text]
    assert boat.rig.arm() in (DENIED, FAILED)
    assert any("Motors: PCA9685: no answer on the I" in text for text in boat.rig.peer.texts)


def test_a_boat_that_cannot_stop_its_motors_says_so_again_and_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    boat, chip = under_way("esc pca9685 without OE", monkeypatch, tmp_path)
    chip.lost = LOST
    boat.run(11.0)  # every 5 s
    assert chip.width_us(0) > 1600.0
    told = [
        one for one in boat.rig.peer.said("STATUSTEXT") if one.text.startswith("Motors do not stop: switch")
    ]
    assert len(told) == 3
    assert {one.severity for one in told} == {dialect.MAV_SEVERITY_CRITICAL}
    assert len(boat.rig.peer.said("HEARTBEAT")) >= 10
    chip.lost = 0
    boat.run(0.1)
    assert chip.width_us(0) == pytest.approx(1500.0, abs=3.0)
    boat.rig.peer.forget()
    boat.run(6.0)
    assert not [text for text in boat.rig.peer.texts if "switch the boat off" in text]
