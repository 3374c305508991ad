"""The u-blox driver on a pseudo-terminal, whose baud rate the receiver compares with its own."""

import os
import threading
import time
from pathlib import Path

import pytest
from twins.lines import PtyLine, eventually
from twins.ubx_receiver import ZED_F9P, Model, UbxReceiver
from twins.ubx_serial import SerialReceiver

from companion.config.sensors import GnssPart
from companion.hal.gnss.ubx import open_ubx_gnss

pytestmark = pytest.mark.slow


@pytest.mark.realtime
@pytest.mark.parametrize("model", [ZED_F9P], ids=lambda model: model.hardware)
def test_a_receiver_is_set_up_over_a_serial_line_and_again_after_unplugging(
    model: Model, tmp_path: Path
) -> None:
    line = PtyLine(tmp_path / "ttyGNSS")
    peer = SerialReceiver(line, UbxReceiver(model))
    gnss = open_ubx_gnss(GnssPart(driver="ubx", port=line.device, rate_hz=10.0), time.monotonic)
    texts: list[str] = []

    def is_set_up(times: int) -> bool:
        peer.run()
        texts.extend(text for _, text in gnss.take_texts())
        return sum("set up" in text and "Hz" in text for text in texts) == times

    eventually(lambda: is_set_up(1))
    settings = peer.receiver.settings
    assert (settings.baud, settings.period_ms, settings.model) == (115_200, 100, 5)
    fix = gnss.read()
    assert fix is not None
    assert fix.north_m_s == pytest.approx(1.2)
    line.unplug()
    peer.receiver.dip()
    line.plug_in()
    eventually(lambda: is_set_up(2))
    began_s = time.monotonic()
    gnss.close()
    gnss.close()
    assert time.monotonic() - began_s < 8.0
    assert not [one for one in threading.enumerate() if one.name.startswith("serial:")]
    line.unplug()
    assert os.path.lexists(line.device) is False
