"""The u-blox driver against a receiver that follows the interface descriptions: set-up, fixes, faults."""

import math

import pytest
from twins.lines import HandClock
from twins.ubx_line import BaudLine
from twins.ubx_receiver import MAX_M10, NEO_6M, NEO_M8N, ZED_F9P, Model, UbxReceiver

from companion.hal.gnss.ubx import UbxGnss
from companion.sensors.gnss_heading import GnssHeading
from companion.sensors.readings import GnssFix
from companion.sensors.ubx.setup import Phase, UbxSetup

SEA = 5
STEP_S = 0.02


class Bench:
    """Driver, line and receiver, on a clock moved by hand."""

    def __init__(
        self,
        model: Model = NEO_M8N,
        *,
        interface: str = "UART1",
        baud: int | None = None,
        rate_hz: float = 5.0,
        heading: GnssHeading | None = None,
        target_baud: int | None = 115_200,
        is_usb: bool = False,
    ) -> None:
        self.clock = HandClock()
        self.receiver = UbxReceiver(model, interface=interface, baud=baud)
        self.line = BaudLine(self.receiver)
        setup = UbxSetup(target_baud, rate_hz, wants_baseline=heading is not None, is_usb=is_usb)
        self.line.baud = target_baud
        self.gnss = UbxGnss(self.line.port, self.clock, setup, 0.05, heading, self.line.set_baud)
        self.texts: list[str] = []
        self.fixes: list[GnssFix] = []

    @property
    def phase(self) -> Phase:
        return self.gnss.setup.phase

    def run(self, seconds: float) -> "Bench":
        for _ in range(round(seconds / STEP_S)):
            self.clock.advance(STEP_S)
            self.line.pump(self.clock())
            self.gnss.step()
            self.texts += [text for _, text in self.gnss.take_texts()]
            fix = self.gnss.read()
            if fix is not None and (not self.fixes or fix is not self.fixes[-1]):
                self.fixes.append(fix)
        return self

    def until_running(self, limit_s: float = 30.0) -> float:
        began_s = self.clock()
        while not any("set up" in text for text in self.texts):
            assert self.clock() - began_s < limit_s, (self.phase, self.texts)
            self.run(STEP_S)
        return self.clock() - began_s


@pytest.mark.parametrize("model", [NEO_M8N, ZED_F9P, MAX_M10], ids=lambda model: model.hardware)
@pytest.mark.parametrize("baud", [None, 4800, 9600, 38400, 57600, 115_200, 460_800])
def test_a_receiver_is_found_at_any_baud_rate_and_set_up(model: Model, baud: int | None) -> None:
    bench = Bench(model, baud=baud)
    bench.until_running()
    settings = bench.receiver.settings
    assert (settings.baud, settings.period_ms, settings.model) == (115_200, 200, SEA)
    assert not settings.nmea_out
    assert bench.texts == [bench.texts[-1]]
    bench.fixes.clear()
    bench.run(2.0)
    assert len(bench.fixes) == pytest.approx(10, abs=1)
    assert bench.receiver.other_layers == []  # only the volatile layer


def test_a_fix_has_the_receivers_velocity_accuracies_and_time() -> None:
    bench = Bench()
    bench.until_running()
    fix = bench.run(1.0).fixes[-1]
    assert (fix.position.lat_deg, fix.position.lon_deg) == pytest.approx((50.5, -1.2), abs=1e-7)
    assert (fix.north_m_s, fix.east_m_s) == pytest.approx((1.2, -0.3))
    assert (fix.horizontal_accuracy_m, fix.vertical_accuracy_m, fix.speed_accuracy_m_s) == pytest.approx(
        (1.5, 3.0, 0.25)
    )
    assert (fix.fix_type, fix.satellites, fix.hdop, fix.altitude_m) == pytest.approx((3, 14, 0.85, 12.5))
    assert fix.unix_time_s is not None
    # 2024-05-28 09:00:00 UTC at second 0 of the receiver
    assert fix.unix_time_s - 1_716_886_800.0 == pytest.approx(fix.time_s, abs=0.15)


@pytest.mark.parametrize(
    ("changes", "fix_type"),
    [
        ({"carrier": 1}, 5),
        ({"carrier": 2}, 6),
        ({"fix_type": 2}, 2),
        ({"fix_type": 4}, 3),
        ({"fix_type": 1}, 1),  # dead reckoning alone
        ({"fix_type": 5}, 1),  # time only
        ({"fix_type": 0}, 1),
        ({"fix_ok": 0}, 1),  # outside the receiver's accuracy masks
    ],
)
def test_fix_quality_follows_the_receivers_flags(changes: dict[str, int], fix_type: int) -> None:
    bench = Bench()
    for name, value in changes.items():
        setattr(bench.receiver.motion, name, value)
    bench.until_running()
    fix = bench.run(1.0).fixes[-1]
    assert fix.fix_type == fix_type
    assert (fix.north_m_s is None) == (fix_type == 1)


@pytest.mark.parametrize("valid", [(0, 1, 1), (1, 0, 1), (1, 1, 0)])
def test_a_time_without_date_or_leap_seconds_is_not_used(valid: tuple[int, int, int]) -> None:
    bench = Bench()
    bench.receiver.motion.valid = valid
    bench.until_running()
    assert bench.run(1.0).fixes[-1].unix_time_s is None


def test_the_age_of_corrections_is_the_upper_bound_of_its_class() -> None:
    bench = Bench(ZED_F9P)
    bench.receiver.motion.correction_age = 4
    bench.until_running()
    assert bench.run(1.0).fixes[-1].correction_age_s == 10.0
    bench.receiver.motion.correction_age = 12
    assert bench.run(1.0).fixes[-1].correction_age_s == math.inf
    bench.receiver.motion.correction_age = 0
    assert bench.run(1.0).fixes[-1].correction_age_s is None


def test_a_u_blox_6_sends_accuracies_and_fixes_as_sentences() -> None:
    bench = Bench(NEO_6M)
    bench.until_running()
    bench.fixes.clear()
    fix = bench.run(2.0).fixes[-1]
    assert len(bench.fixes) == pytest.approx(10, abs=1)
    assert (fix.fix_type, fix.satellites) == (3, 9)
    assert fix.horizontal_accuracy_m == pytest.approx(2.5)
    assert bench.receiver.settings.outputs["NMEA3"] == 0  # GSV is most of the bytes, and unused


@pytest.mark.parametrize("model", [NEO_M8N, ZED_F9P, NEO_6M], ids=lambda model: model.hardware)
def test_a_power_dip_is_followed_by_another_set_up(model: Model) -> None:
    bench = Bench(model)
    bench.until_running()
    bench.run(3.0)
    bench.texts.clear()
    bench.receiver.dip()
    assert bench.until_running() < 10.0
    assert bench.texts[0] == "GNSS: receiver silent, setting it up again"
    assert "set up again" in bench.texts[-1]
    assert (bench.receiver.settings.baud, bench.receiver.settings.model) == (115_200, SEA)


def test_a_receiver_without_power_is_reported_once_and_found_when_it_has_some() -> None:
    bench = Bench()
    bench.receiver.is_mute = True
    bench.run(40.0)
    assert bench.texts == ["GNSS: silent at every baud rate, check wiring"]
    assert bench.gnss.read() is None
    bench.receiver.is_mute = False
    bench.until_running()


@pytest.mark.parametrize("baud", [4800, 9600, 115_200])
def test_a_receiver_that_cannot_hear_is_read_as_it_is(baud: int) -> None:
    bench = Bench(NEO_M8N, baud=baud)
    bench.receiver.is_deaf = True
    bench.run(20.0)
    assert bench.phase is Phase.LISTENING
    assert bench.texts == ["GNSS: receiver does not answer: using its own settings"]
    fix = bench.run(2.0).fixes[-1]
    assert bench.clock() - fix.time_s < 2.5
    assert (fix.fix_type, fix.satellites) == (3, 9)
    bench.receiver.is_deaf = False  # the wire is put in its place
    bench.until_running(40.0)


def test_a_receiver_that_listening_lost_is_searched_again() -> None:
    bench = Bench(NEO_M8N)
    bench.receiver.is_deaf = True
    bench.run(20.0)
    bench.receiver.is_deaf, bench.receiver.saved_baud = False, 38400
    bench.receiver.dip()
    bench.until_running()


@pytest.mark.parametrize(
    ("refused", "text"),
    [((0x06, 0x24), "sea model"), ((0x06, 0x08), "navigation rate"), ((0x06, 0x01), "output of messages")],
)
def test_a_refusal_is_reported_and_the_rest_is_set(refused: tuple[int, int], text: str) -> None:
    bench = Bench(NEO_M8N)
    bench.receiver.refused.add(refused)
    bench.run(15.0)
    assert f"GNSS: receiver refused: {text}" in bench.texts
    if text != "output of messages":
        assert bench.phase is Phase.RUNNING
        assert bench.fixes
    else:
        assert bench.phase is Phase.LISTENING
        assert bench.clock() - bench.run(2.0).fixes[-1].time_s < 2.5  # by its sentences


def test_a_receiver_that_acknowledges_nothing_is_still_read() -> None:
    bench = Bench(NEO_M8N)
    bench.receiver.unacknowledged = True
    bench.until_running(40.0)
    assert "GNSS: no acknowledgement: navigation rate" in bench.texts
    assert bench.receiver.settings.nmea_out
    assert bench.phase is Phase.RUNNING


def test_a_refused_baud_rate_leaves_the_one_that_works() -> None:
    bench = Bench(NEO_M8N)
    bench.receiver.refused.add((0x06, 0x00))
    bench.until_running()
    assert "GNSS: receiver silent at 115200 baud" in bench.texts
    assert bench.receiver.settings.baud == 9600
    assert bench.receiver.settings.model == SEA


@pytest.mark.parametrize("interface", ["UART1", "UART2", "USB"])
@pytest.mark.parametrize("is_usb", [False, True])
def test_the_connected_port_of_the_receiver_is_found(interface: str, is_usb: bool) -> None:
    bench = Bench(ZED_F9P, interface=interface, is_usb=is_usb)
    bench.until_running()
    assert bench.run(1.0).fixes


def test_noise_on_the_line_delays_the_set_up_but_does_not_stop_it() -> None:
    bench = Bench(ZED_F9P)
    bench.line.garbles_every = 311  # every third NAV-PVT
    bench.until_running(60.0)
    bench.fixes.clear()
    bench.run(10.0)
    assert len(bench.fixes) > 25
    assert all(abs(fix.position.lat_deg - 50.5) < 1e-6 for fix in bench.fixes)


def first_text_after(bench: Bench, limit_s: float) -> tuple[float, str]:
    """Seconds until the next message, and the message."""
    bench.texts.clear()
    began_s = bench.clock()
    while not bench.texts:
        assert bench.clock() - began_s < limit_s
        bench.run(STEP_S)
    return bench.clock() - began_s, bench.texts[0]


def test_silence_is_noticed_within_two_seconds_of_the_last_solution() -> None:
    bench = Bench()
    bench.until_running()
    bench.receiver.is_mute = True
    seconds, text = first_text_after(bench, 10.0)
    assert text == "GNSS: receiver silent, setting it up again"
    assert 1.8 < seconds < 2.3
    seconds, text = first_text_after(bench, 30.0)
    assert text == "GNSS: silent at every baud rate, check wiring"
    assert seconds == pytest.approx(8 * 1.2, abs=0.5)  # each of eight rates for longer than a period


def test_a_slow_receiver_is_given_five_periods() -> None:
    bench = Bench(rate_hz=1.0)
    bench.until_running()
    bench.receiver.is_mute = True
    seconds, _ = first_text_after(bench, 10.0)
    assert 4.0 < seconds < 5.3


def test_sentences_without_an_answer_are_used_after_four_seconds() -> None:
    bench = Bench(NEO_M8N, baud=115_200)
    bench.receiver.is_deaf = True
    seconds, text = first_text_after(bench, 10.0)
    assert "does not answer" in text
    assert 3.8 < seconds < 5.5


def test_an_unplugged_receiver_is_set_up_again_at_once() -> None:
    bench = Bench(ZED_F9P, interface="USB", is_usb=True, target_baud=None)
    bench.until_running()
    bench.texts.clear()
    bench.line.replug()
    assert bench.until_running() < 4.0
    assert bench.receiver.settings.model == SEA


def test_fixes_are_stamped_with_the_time_of_measurement() -> None:
    bench = Bench(rate_hz=10.0)
    bench.until_running()
    bench.fixes.clear()
    bench.run(5.0)
    gaps_s = {round(b.time_s - a.time_s, 3) for a, b in zip(bench.fixes, bench.fixes[1:], strict=False)}
    assert gaps_s == {0.1}


def test_a_heading_of_two_antennas_is_accepted_and_its_loss_reported() -> None:
    heading = GnssHeading(antenna_bearing_rad=math.radians(-10.0), baseline_m=1.0, latency_s=0.05)
    bench = Bench(ZED_F9P, heading=heading)
    bench.until_running()
    bench.run(2.0)
    reading = heading.latest
    assert reading is not None
    assert math.degrees(reading.heading_rad) == pytest.approx(100.0)
    assert bench.clock() - reading.time_s < 0.4
    assert [fix.heading_rad for fix in bench.fixes[-1:]] == [reading.heading_rad]
    assert bench.fixes[-1].heading_accuracy_rad == pytest.approx(math.radians(0.4))
    bench.texts.clear()
    bench.receiver.motion.baseline_carrier = 1
    bench.run(5.0)
    assert bench.texts == ["GNSS heading lost: baseline not fixed"]
    latest = heading.latest
    assert latest is not None
    assert bench.clock() - latest.time_s > 4.0
    last: GnssFix = bench.fixes[-1]
    assert last.heading_rad is None
    bench.receiver.motion.baseline_carrier = 2
    bench.run(1.0)
    assert bench.texts[1:] == ["GNSS heading is back"]


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"length_m": 1.12}, "baseline 1.12 m, expected 1.00 m"),
        ({"length_m": 0.81}, "baseline 0.81 m, expected 1.00 m"),
        ({"heading_accuracy": 7.0}, "accuracy 7 degrees"),
        ({"heading_valid": 0}, "no baseline between the antennas"),
    ],
)
def test_a_doubtful_heading_is_not_used(changes: dict[str, float], why: str) -> None:
    heading = GnssHeading(baseline_m=1.0)
    bench = Bench(ZED_F9P, heading=heading)
    for name, value in changes.items():
        setattr(bench.receiver.motion, name, value)
    bench.until_running()
    bench.run(60.0)
    assert heading.latest is None
    assert f"GNSS heading lost: {why}" in bench.texts


def test_a_receiver_without_a_baseline_message_says_so() -> None:
    bench = Bench(NEO_M8N, heading=GnssHeading())
    bench.until_running()
    bench.run(60.0)
    assert "GNSS heading lost: no heading from the receiver" in bench.texts
    bench = Bench(MAX_M10, heading=GnssHeading())
    bench.until_running()
    assert "GNSS: receiver refused: output of NAV-RELPOSNED" in bench.texts
