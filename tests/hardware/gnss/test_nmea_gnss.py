"""Receiver and compass behind ports: in memory step by step, and over a serial line with their threads."""

import pytest
from twins.lines import HandClock, MemoryLine, known
from twins.ubx_messages import sentence

from companion.hal.gnss.receiver import NmeaGnss


def epoch(second: int, satellites: int = 9) -> bytes:
    return sentence(f"GNRMC,0927{second:02}.00,A,5030.0,N,00112.0,W,2.0,90.0,280524,,,A") + sentence(
        f"GNGGA,0927{second:02}.00,5030.0,N,00112.0,W,1,{satellites},0.85,12.5,M,47.0,M,,"
    )


def test_the_latest_fix_stays_until_a_new_one_has_come_and_bears_its_arrival_time(
    wire: MemoryLine, clock: HandClock
) -> None:
    gnss = NmeaGnss(wire.port, clock)
    assert gnss.read() is None
    wire.say(epoch(0))
    gnss.step()
    clock.advance(1.0)
    wire.say(epoch(1))
    gnss.step()
    first = known(gnss.read())
    assert first.time_s == clock()
    clock.advance(0.5)
    gnss.step()
    assert gnss.read() is first


def test_fixes_bear_the_time_of_their_measurement_however_late_the_line_brings_them(
    wire: MemoryLine, clock: HandClock
) -> None:
    gnss = NmeaGnss(wire.port, clock, latency_s=0.1)
    began_s, dates_s = clock(), []
    for second, late_s in enumerate([0.3, 0.15, 0.4, 0.12, 0.25, 0.9, 0.12]):
        clock.advance(began_s + second + late_s - clock())
        wire.say(epoch(second))
        gnss.step()
        if (fix := gnss.read()) is not None:  # the first epoch ends when the second begins
            dates_s.append(fix.time_s - began_s - second)
    # From the fastest one on, all are off only by what that took longer than assumed.
    assert dates_s == pytest.approx([0.05, 0.05, 0.02, 0.02, 0.02, 0.02], abs=1e-6)


def test_a_silent_receiver_and_a_wrong_baud_rate_are_told_apart(wire: MemoryLine, clock: HandClock) -> None:
    gnss = NmeaGnss(wire.port, clock)

    def texts_after(seconds: float, data: bytes = b"") -> list[str]:
        clock.advance(seconds)
        wire.say(data)
        gnss.step()
        return [text for _, text in gnss.take_texts()]

    assert texts_after(5.0) == []
    assert texts_after(0.1) == ["GNSS receiver is silent"]
    assert texts_after(60.0) == []
    assert texts_after(0.1, epoch(0)) == ["GNSS receiver measures again"]
    assert texts_after(5.0, b"\x86\xf8\x00\xfe") == []
    assert texts_after(0.1) == ["GNSS receiver sends no sentences; check parts.gnss.baud"]
    assert texts_after(0.1, sentence("GPTXT,01,01,02,ANTSTATUS=OK")) == ["GNSS receiver measures again"]
