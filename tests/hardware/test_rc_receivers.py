"""RC receivers behind ports: in memory step by step, and over a serial line with their thread."""

import array
import fcntl
import os
import termios
from pathlib import Path

import pytest
from twins.lines import HandClock, PtyLine, eventually

from companion.config.tuning import Rc
from companion.hal.rc_receiver import SerialRcReceiver, open_rc_receiver
from companion.links.memory import MemoryPort, memory_pair
from companion.links.serial_port import LINE_8E2, SerialPort
from companion.rc.parsers import CrsfParser

CRSF = bytes.fromhex("c81816e0031ff8c0073ef0810f7ce0031ff8c0073ef0810f7cad")
IBUS = bytes.fromhex("2040" + "dc05" * 14 + "51f3")
SBUS = bytes.fromhex("0fe0031ff8c0073ef0810f7ce0031ff8c0073ef0810f7c0000")
_TCGETS2 = 0x802C542A


def test_the_latest_frame_stays_until_a_new_one_has_come_and_bears_its_arrival_time() -> None:
    near, far = memory_pair(is_datagram=False)
    clock = HandClock()
    receiver = SerialRcReceiver(MemoryPort(near), clock, CrsfParser())
    assert receiver.read() is None
    far.send(CRSF[:20])
    receiver.step()
    assert receiver.read() is None
    clock.advance(0.004)
    far.send(CRSF[20:])
    receiver.step()
    first = receiver.read()
    assert first is not None
    assert first.time_s == clock()
    clock.advance(1.0)
    receiver.step()
    assert receiver.read() is first


@pytest.mark.parametrize(
    ("driver", "frame", "channels"), [("crsf", CRSF, 16), ("ibus", IBUS, 14), ("sbus", SBUS, 18)]
)
def test_a_receiver_is_read_from_its_device_and_again_after_it_was_unplugged(
    tmp_path: Path, driver: str, frame: bytes, channels: int
) -> None:
    line, clock = PtyLine(tmp_path / "uart"), HandClock()
    setting = Rc(driver=driver, port=line.device)  # type: ignore[arg-type]
    receiver = open_rc_receiver(setting, clock)

    def heard() -> int:
        clock.advance(0.01)
        line.say(frame)
        reading = receiver.read()
        return 0 if reading is None or reading.time_s < since_s else len(reading.channels_us)

    try:
        since_s = 0.0
        eventually(lambda: heard() == channels)
        line.unplug()
        line.plug_in()
        since_s = clock() + 1.0
        clock.advance(2.0)
        eventually(lambda: heard() == channels)
    finally:
        receiver.close()
        receiver.close()


def test_the_line_has_the_speed_of_crossfire_which_is_no_usual_one(tmp_path: Path) -> None:
    line = PtyLine(tmp_path / "uart")
    receiver = open_rc_receiver(Rc(driver="crsf", port=line.device), HandClock())
    try:
        descriptor = os.open(line.device, os.O_RDWR | os.O_NOCTTY)
        settings = array.array("i", [0] * 64)
        fcntl.ioctl(descriptor, _TCGETS2, settings)
        os.close(descriptor)
        assert settings[9:11].tolist() == [420000, 420000]
    finally:
        receiver.close()


def test_bytes_with_a_wrong_parity_are_dropped_by_the_line(tmp_path: Path) -> None:
    line = PtyLine(tmp_path / "uart")
    port = SerialPort(line.device, 100000, HandClock(), line=LINE_8E2)
    (link,) = port.accept()
    try:
        input_flags, _, control_flags, *_ = termios.tcgetattr(link.fileno())
        assert input_flags & termios.INPCK
        assert input_flags & termios.IGNPAR
        assert control_flags & termios.CSTOPB
        assert not control_flags & termios.PARODD
    finally:
        port.close()
