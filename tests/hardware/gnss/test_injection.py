"""Corrections on their way to the receiver: over its line, no faster than that, and only at its baud rate."""

from twins.lines import HandClock, MemoryLine
from twins.ubx_bench import BaudLine
from twins.ubx_receiver import ZED_F9P, UbxReceiver

from companion.hal.gnss.receiver import NmeaGnss
from companion.hal.gnss.ubx import UbxGnss
from companion.sensors.ubx.setup import Phase, UbxSetup

FRAME = bytes.fromhex("D300133ED7D30202980EDEEF34B4BD62AC0941986F33360B98")


def test_a_u_blox_receiver_gets_corrections_after_its_set_up_only() -> None:
    clock, receiver = HandClock(), UbxReceiver(ZED_F9P)
    line, setup = BaudLine(receiver), UbxSetup(115_200, 5.0)
    line.baud = 115_200
    gnss = UbxGnss(line.port, clock, setup, set_baud=line.set_baud)
    while setup.phase.name != Phase.RUNNING.name:
        clock.advance(0.1)
        gnss.inject(FRAME)
        line.pump(clock())
        gnss.step()
    assert receiver.rtcm == b""
    for _ in range(10):
        clock.advance(0.1)
        assert gnss.inject(FRAME)
        line.pump(clock())
        gnss.step()
    line.pump(clock())
    assert receiver.rtcm == 11 * FRAME  # the latest of the set-up included
    receiver.dip()
    receiver.rtcm = b""
    while setup.phase.name != Phase.SEARCH.name:
        clock.advance(0.1)
        line.pump(clock())
        gnss.step()
    gnss.inject(FRAME)
    gnss.step()
    line.pump(clock())
    assert receiver.rtcm == b""


def test_a_slow_line_is_not_overrun(wire: MemoryLine, clock: HandClock) -> None:
    gnss = NmeaGnss(wire.port, clock, baud=9600)
    frame, taken = bytes(200), 0
    for _ in range(100):  # ten seconds of 2000 bytes/s
        clock.advance(0.1)
        taken += gnss.inject(frame)
        gnss.step()
    assert 9600 <= taken * len(frame) <= 9600 + 960
    assert len(wire.heard()) == taken * len(frame)
