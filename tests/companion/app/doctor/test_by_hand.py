"""`boat-companion doctor --compass`: four positions of the boat, and a BNO055 that is turned with it."""

from pathlib import Path

import pytest
from twins.i2c import Bno055Twin, plug_in

from companion.app.doctor.by_hand import turn_by_hand
from companion.app.doctor.findings import Finding, Verdict
from companion.app.runner import SystemClock
from companion.config.boat_config import BoatConfig, Parts
from companion.config.sensors import CompassPart, Mounting

POSITIONS = {  # heading, roll, pitch, by a word of the question
    "north": (2.0, 0.0, 0.0),
    "east": (93.0, 0.0, 0.0),
    "Lift the bow": (93.0, 1.0, 22.0),
    "starboard side down": (93.0, 25.0, 1.0),
}


def check(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    part: CompassPart,
    mounted: tuple[str, str, str] = ("bow", "port", "up"),
) -> Finding:
    chip = Bno055Twin(mounted=mounted)
    plug_in(monkeypatch, tmp_path, {0x28: chip})

    def ask(question: str) -> str:
        for word, (heading, roll, pitch) in POSITIONS.items():
            if word in question:
                chip.heading_deg, chip.roll_deg, chip.pitch_deg = heading, roll, pitch
        return ""

    return turn_by_hand(BoatConfig(parts=Parts(compass=part)), SystemClock(), ask, said.append)


said: list[str] = []
BNO055 = CompassPart(driver="bno055")


def test_a_sensor_that_points_ahead_is_fine(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    said.clear()
    found = check(monkeypatch, tmp_path, BNO055)
    assert (found.verdict, found.text) == (Verdict.FINE, "heading, pitch and roll follow the boat")
    assert said[0].startswith("  heading 2° ")
    assert said[-1].endswith("roll 25°, pitch 1°")


def test_a_board_that_is_turned_is_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    mounted = ("stern", "starboard", "up")
    found = check(monkeypatch, tmp_path, BNO055, mounted)
    assert (found.verdict, found.text) == (
        Verdict.FAILED,
        "heading 182° instead of 0°; heading 273° instead of 90°; pitch -22° where it should have grown; "
        "roll -25° where it should have grown",
    )
    assert "parts.compass.mounting" in found.cure
    turned = CompassPart(driver="bno055", mounting=Mounting(yaw_deg=180))
    assert check(monkeypatch, tmp_path, turned, mounted).verdict is Verdict.FINE
