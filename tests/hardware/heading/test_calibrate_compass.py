"""`boat-companion calibrate-compass` on a magnetometer that is turned by hand."""

from pathlib import Path

import pytest
from twins.i2c import plug_in
from twins.inertial import Lsm6dsTwin
from twins.magnetics import Qmc5883lTwin, Scene

from companion.app.calibrate import calibrate_compass
from companion.config.boat_config import BoatConfig, with_value
from companion.config.parameter_table import ROWS
from companion.config.parameters import Parameters
from companion.core.errors import HardwareError
from companion.core.storage import FolderStorage
from companion.hal.heading.magnetic_compass import MagneticCompass
from companion.sensors.compass.magnetic_field import FieldCorrector, compass_hooks

pytestmark = pytest.mark.slow


class Hand:
    """The clock of the program: as it waits, the boat is turned and the compass's thread runs."""

    def __init__(self) -> None:
        self.time_s = 100.0
        self.scene = Scene(self.now_s)
        self.compass: MagneticCompass | None = None

    def now_s(self) -> float:
        return self.time_s

    def sleep(self, seconds: float) -> None:
        self.time_s += seconds
        self.scene.turn(seconds)
        if self.compass is not None:
            self.compass.step()


@pytest.fixture
def hand(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Hand:
    hand = Hand()
    monkeypatch.setattr(Qmc5883lTwin, "starts_s", 0.0)
    monkeypatch.setattr("companion.hal.heading.magnetometers._RESET_S", 0.0)
    plug_in(monkeypatch, tmp_path, {0x0D: Qmc5883lTwin(hand.scene), 0x6A: Lsm6dsTwin(hand.scene)})

    def start(compass: MagneticCompass) -> MagneticCompass:
        hand.compass = compass
        return compass

    monkeypatch.setattr(MagneticCompass, "start", start)
    return hand


def config(tmp_path: Path, **values: object) -> BoatConfig:
    tree = BoatConfig()
    settings = {"parts.compass.driver": "qmc5883l", "parts.compass.imu": "lsm6ds", **values}
    for path, value in {"storage.folder": str(tmp_path / "state"), **settings}.items():
        tree = with_value(tree, path, value)
    return tree


def test_one_turn_calibrates_and_the_boat_starts_with_it(hand: Hand, tmp_path: Path) -> None:
    tree, said = config(tmp_path), list[str]()
    storage = FolderStorage(tmp_path / "state")
    hand.scene.yaw_rate_deg_s, hand.scene.iron_mg = 20.0, (120.0, -60.0, 30.0)
    calibrate_compass(tree, storage, hand, said.append)
    storage.close()
    assert said[0].startswith("Turn the boat slowly")
    assert said[1] == "10 %" or said[1] == "20 %"
    assert said[-1].startswith("Calibrated: offsets -1")
    corrector = FieldCorrector()
    Parameters(tree, ROWS, FolderStorage(tmp_path / "state"), compass_hooks(corrector))
    assert corrector.correction.offset[:2] == pytest.approx((-120.0, 60.0), abs=6.0)


def test_a_boat_that_is_not_turned_ends_with_a_reason(
    hand: Hand, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("companion.calibration.compass.TIMEOUT_S", 20.0)
    with pytest.raises(HardwareError, match=r"compass: only \d+ % of the directions were seen"):
        calibrate_compass(config(tmp_path), FolderStorage(tmp_path / "state"), hand, lambda _: None)


def test_a_running_boat_keeps_its_compass(
    hand: Hand, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("companion.app.calibrate.running_boat", lambda _: object())
    with pytest.raises(HardwareError, match="sudo systemctl stop mavboat"):
        calibrate_compass(config(tmp_path), FolderStorage(tmp_path / "state"), hand, print)
