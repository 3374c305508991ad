"""The boats of the presets start with whatever is there: the real composition over twins of their parts."""

import sys
import threading
import time
import tomllib
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, Self

import gpiozero
import pytest
from gpiozero.pins.mock import MockFactory, MockPWMPin
from mavutil_station import MavutilStation
from patience import MOMENT_S
from pymavlink import mavutil
from pymavlink.dialects.v20 import all as dialect
from twins.battery import Ads1115Twin, Ina219Twin, Ina226Twin
from twins.i2c import Bno055Twin, Part, plug_in
from twins.lines import PtyLine
from twins.pulses import PI_4, LgpioTwin, plug_in_pwm

from companion.app import parts
from companion.app.composition import run_boat
from companion.app.hardware import open_hardware
from companion.app.init.presets import preset_text
from companion.config.boat_config import BoatConfig, decode_config
from companion.links.port_url import open_port
from companion.links.retried import Pace

pytestmark = [pytest.mark.realtime, pytest.mark.slow]
QUICK = Pace(0.02, 0.02, 0.5)
ANSWER_S = 8 * 2.0  # on a machine with eight times its load
MANUAL = 0
OK, FAILED = dialect.MAV_RESULT_ACCEPTED, dialect.MAV_RESULT_FAILED
BATTERY = dialect.MAV_SYS_STATUS_SENSOR_BATTERY
ECHO, FORWARD = 24, 5  # pins of the presets

MORE = """
[rc]
driver = "crsf"
port = "{folder}/rc"

[parts.depth]
driver = "nmea"
port = "{folder}/depth"

[parts.hull]
driver = "host"

[[probe]]
name = "ph"
driver = "ads1115"
channel = 0
"""


class Pi:
    """A Pi with every part plugged in. unplug and plug_in take a part's name."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, folder: Path, preset: str) -> None:
        self.preset = preset
        monitor = Ina219Twin if preset in ("lake", "pool") else Ina226Twin
        self._chips: dict[str, tuple[int, Part]] = {
            "Compass": (0x28, Bno055Twin()),
            "Battery monitor": (0x40, monitor(time.monotonic)),
            "probe ph": (0x48, Ads1115Twin(time.monotonic)),
        }
        self._bus = plug_in(monkeypatch, folder, dict(self._chips.values()))
        self._lines = {
            name: PtyLine(folder / device)
            for name, device in {
                "GNSS receiver": "gnss",
                "RC receiver": "rc",
                "Depth sounder": "depth",
                f"serial:{folder}/radio:57600": "radio",
            }.items()
        }
        monkeypatch.setattr(gpiozero.Device, "pin_factory", MockFactory(pin_class=MockPWMPin))
        self._pins = {"Sonar": ECHO}
        self._held: dict[str, Any] = {}
        self._pwm = plug_in_pwm(monkeypatch, folder, PI_4).root
        if preset in ("lake", "pool"):
            self._pins["Motors"] = FORWARD
        monkeypatch.setitem(sys.modules, "lgpio", LgpioTwin({0: "pinctrl-bcm2711"}))

    def unplug(self, name: str) -> None:
        """Pins are taken by somebody else; the Pi's PWM lacks its overlay."""
        if name in self._chips:
            self._bus.parts.pop(self._chips[name][0], None)
        elif name in self._lines:
            self._lines[name].unplug()
        elif name in self._pins:
            self._held[name] = gpiozero.InputDevice(self._pins[name])
        else:
            self._pwm.rename(self._pwm.with_name("none"))

    def plug_in(self, name: str) -> None:
        if name in self._chips:
            address, chip = self._chips[name]
            self._bus.parts[address] = chip
        elif name in self._lines:
            self._lines[name].plug_in()
        elif name in self._pins:
            self._held.pop(name).close()
        else:
            self._pwm.with_name("none").rename(self._pwm)

    def close(self) -> None:
        for line in self._lines.values():
            line.unplug()
        for pin in self._held.values():
            pin.close()


class Station(MavutilStation):
    """Listens before the boat starts, so that it hears everything."""

    def __init__(self) -> None:
        self.link = mavutil.mavlink_connection("udpin:127.0.0.1:0", source_system=255)
        self.mav = self.link.mav
        self.port = self.link.port.getsockname()[1]
        self.texts: list[str] = []
        self.link.message_hooks.append(self._hear)

    def _hear(self, _: object, message: Any) -> None:  # noqa: ANN401
        if message.get_type() == "STATUSTEXT":
            if message.chunk_seq == 0:
                self.texts.append("")
            self.texts[-1] += message.text

    def wait_for_text(self, beginning: str) -> None:
        if not any(text.startswith(beginning) for text in self.texts):
            self.wait_for("STATUSTEXT", lambda _: any(text.startswith(beginning) for text in self.texts))

    def arms(self) -> bool:
        """Whether the boat armed in MANUAL, once its compass has spoken."""
        give_up_s = time.monotonic() + MOMENT_S
        while (result := self.arm()) != OK and time.monotonic() < give_up_s:
            time.sleep(0.05)
        return bool(result == OK)

    def is_answered(self) -> None:
        """A heartbeat and an acknowledgement, in time."""
        began_s = time.monotonic()
        self.wait_for("HEARTBEAT", timeout_s=ANSWER_S)
        assert self.enter(MANUAL) == OK
        assert time.monotonic() - began_s < ANSWER_S


class RunningBoat:
    """The boat's program in a thread."""

    def __init__(self, config: BoatConfig) -> None:
        self._stop = threading.Event()
        self._errors: list[BaseException] = []
        self._thread = threading.Thread(target=self._run, args=(config,))

    def _run(self, config: BoatConfig) -> None:
        try:
            run_boat(config, self._stop.is_set, open_parts=partial(open_hardware, pace=QUICK))
        except BaseException as error:
            self._errors.append(error)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join(MOMENT_S)
        assert self._errors == []


Bench = Callable[[str], tuple[Pi, Station, RunningBoat]]


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Bench]:
    """A preset with a transmitter, a sounder, a probe and a radio besides, which is not switched on yet."""
    opened: list[Pi | Station] = []

    def put_together(preset: str) -> tuple[Pi, Station, RunningBoat]:
        pi, station = Pi(monkeypatch, tmp_path, preset), Station()
        opened.extend((pi, station))
        text = preset_text(
            preset, {"parts.gnss.port": f"{tmp_path}/gnss", "storage.folder": f"{tmp_path}/state"}
        )
        tree = tomllib.loads(text + MORE.format(folder=tmp_path))
        tree["links"] = [f"udpout:127.0.0.1:{station.port}", f"serial:{tmp_path}/radio:57600"]
        tree["failsafe"]["overrun_action"] = 0  # the machine may be busy with other tests
        return pi, station, RunningBoat(decode_config(tree, preset))

    yield put_together
    for one in opened:
        one.close()


RADIO = "serial:{folder}/radio:57600"
NEEDED = {
    "Motors": "Motors: ",
    "Rudder": "Motors: ",
    "Compass": "Compass: no heading",
    "Battery monitor": "Battery: unhealthy",
}
ALL = (
    "Motors", "Compass", "Sonar", "Battery monitor", "GNSS receiver", "RC receiver", "Depth sounder",
    "probe ph", RADIO,
)  # fmt: skip
ALONE = ("Motors", "Compass", "Sonar", "Battery monitor", "GNSS receiver", RADIO)
ROWS = [*(("lake", name) for name in ALONE), ("rudder", "Motors"), ("rudder", "Rudder")]


@pytest.mark.parametrize(("preset", "name"), ROWS)
def test_a_boat_answers_without_a_part_and_takes_it_when_it_comes(
    bench: Bench, tmp_path: Path, preset: str, name: str
) -> None:
    pi, station, boat = bench(preset)
    name = name.format(folder=tmp_path)
    pi.unplug(name)
    with boat:
        station.is_answered()
        station.wait_for_text(f"{name}: ")
        if name in NEEDED:
            assert station.arm() == FAILED
            station.wait_for_text(f"Arm: {NEEDED[name]}")
        else:
            assert station.arms()
        if name == "Battery monitor":
            station.wait_for(
                "SYS_STATUS",
                lambda now: (
                    now.onboard_control_sensors_present & ~now.onboard_control_sensors_health & BATTERY
                ),
            )
        pi.plug_in(name)
        station.wait_for_text(f"{name}: opened")
        if name in NEEDED:
            assert station.arms()
        if name == "Battery monitor":
            station.wait_for("SYS_STATUS", lambda now: now.onboard_control_sensors_health & BATTERY)
        assert len([text for text in station.texts if text.startswith(f"{name}: ")]) == 2


@pytest.mark.parametrize("preset", ["lake", "rudder"])
def test_a_boat_answers_without_any_part(bench: Bench, preset: str, tmp_path: Path) -> None:
    pi, station, boat = bench(preset)
    names = [name.format(folder=tmp_path) for name in ALL]
    for name in names:
        pi.unplug(name)
    with boat:
        station.is_answered()
        assert station.arm() == FAILED
        for name in names:
            pi.plug_in(name)
        assert station.arms()


def test_a_boat_answers_while_motors_parts_and_a_link_hang(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, station, boat = bench("lake")
    may_go_on = threading.Event()

    def hanging(
        work: Callable[..., Any], is_hung: Callable[..., bool] = lambda *_: True
    ) -> Callable[..., Any]:
        def hang(*arguments: Any) -> Any:  # noqa: ANN401
            if is_hung(*arguments):
                may_go_on.wait()
            return work(*arguments)

        return hang

    for name in ("open_motors", "open_compass", "open_battery"):
        monkeypatch.setattr(parts, name, hanging(getattr(parts, name)))
    is_radio = lambda url, *_: url.startswith("serial")  # noqa: E731
    monkeypatch.setattr("companion.app.composition.open_port", hanging(open_port, is_radio))
    with boat:
        station.is_answered()
        assert station.arm() == FAILED
        station.wait_for_text("Arm: Motors: not open yet")
        may_go_on.set()
        assert station.arms()


def test_a_boat_whose_parts_come_loose_in_its_first_second_goes_on(bench: Bench, tmp_path: Path) -> None:
    pi, station, boat = bench("lake")
    names = [name.format(folder=tmp_path) for name in ALL if name not in ("Motors", "Sonar")]
    with boat:
        station.is_answered()
        for name in names:
            pi.unplug(name)
        station.wait_for_text("Battery monitor is silent")
        station.is_answered()
        assert station.arm() == FAILED
        for name in names:
            pi.plug_in(name)
        station.wait_for_text("Battery monitor measures again")
        assert station.arms()
