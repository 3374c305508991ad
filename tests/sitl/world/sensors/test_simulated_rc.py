"""The emulated transmitter and its receiver: sticks by the scenario's times, and what distance takes."""

import pytest

from companion.core.readings import RcReading
from sitl.world.sensors.rc import SimRc
from sitl.world.sensors.settings import RcSettings, StickStep

FULL_AHEAD, RELEASED = (1500, 1500, 2000), (1500, 1500, 1500)
EXACT = RcSettings(
    noise_us=0.0,
    range_m=200.0,
    sticks=(StickStep(at_s=1.0, channels=FULL_AHEAD), StickStep(at_s=2.0, channels=RELEASED)),
)


def frames(away_m: float, seconds: float = 3.0) -> list[RcReading]:
    """Every frame that arrives from a hand north and east of the origin."""
    receiver, heard = SimRc(EXACT, 1, 30.0, 40.0), list[RcReading]()
    for tick in range(round(seconds * 50)):
        receiver.sample(0.02 * tick, 30.0 + 0.6 * away_m, 40.0 + 0.8 * away_m)
        reading = receiver.read()
        if reading is not None and (not heard or reading is not heard[-1]):
            heard.append(reading)
    return heard


def test_the_sticks_move_at_the_times_of_the_scenario() -> None:
    heard = frames(0.0)
    assert len(heard) == 150
    sticks = {time_s: next(one.channels_us for one in heard if one.time_s >= time_s) for time_s in (0, 1, 2)}
    assert sticks == {0: (1500,) * 16, 1: FULL_AHEAD, 2: RELEASED}
    assert next(one.time_s for one in heard if one.channels_us == FULL_AHEAD) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("away_m", "quality", "rssi_dbm"), [(10.0, 1.0, -60.0), (100.0, 1.0, -80.0), (150.0, 0.5, -83.5)]
)
def test_signal_and_quality_fall_with_the_distance(away_m: float, quality: float, rssi_dbm: float) -> None:
    heard = frames(away_m, 10.0)
    assert heard[0].quality == pytest.approx(quality)
    assert heard[0].rssi_dbm == pytest.approx(rssi_dbm, abs=0.05)
    assert len(heard) == pytest.approx(500 * quality, abs=40 * (1.0 - quality))


def test_beyond_its_range_the_receiver_reports_that_it_has_lost_the_transmitter() -> None:
    assert all(reading.is_failsafe for reading in frames(201.0))
    assert not any(reading.is_failsafe for reading in frames(199.0))
