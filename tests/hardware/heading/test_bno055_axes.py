"""A BNO055 turned with the boat: heading, roll and pitch are the boat's, however the part is mounted."""

import math

import pytest
from twins.i2c import Bno055Twin, I2cDev
from twins.lines import HandClock, eventually, known

from companion.config.sensors import CompassPart, Mounting, QuarterTurn
from companion.hal.heading.bno055 import Bno055Compass, open_bno055


def heading_roll_pitch(compass: Bno055Compass) -> tuple[float, float, float]:
    reading = known(compass.read())
    assert reading.roll_rad is not None
    assert reading.pitch_rad is not None
    heading = math.degrees(reading.heading_rad) % 360.0
    return heading, math.degrees(reading.roll_rad), math.degrees(reading.pitch_rad)


@pytest.mark.parametrize(
    ("mounted", "mounting"),
    [
        (("bow", "port", "up"), {}),
        (("starboard", "bow", "up"), {"yaw_deg": 90}),
        (("stern", "starboard", "up"), {"yaw_deg": 180}),
        (("bow", "starboard", "down"), {"roll_deg": 180}),
        (("bow", "up", "starboard"), {"roll_deg": 90}),
        (("up", "port", "stern"), {"pitch_deg": 90}),
    ],
)
@pytest.mark.parametrize(
    ("heading_deg", "roll_deg", "pitch_deg"),
    [
        (0.5, 0.0, 0.0),  # the bow to the north
        (300.0, 25.0, 15.0),  # the starboard side down, the bow up
    ],
)
def test_the_bow_is_where_the_arrow_or_the_mounting_says(
    dev: I2cDev,
    clock: HandClock,
    mounted: tuple[str, str, str],
    mounting: dict[str, QuarterTurn],
    heading_deg: float,
    roll_deg: float,
    pitch_deg: float,
) -> None:
    chip = Bno055Twin(mounted=mounted)
    dev.parts[0x28] = chip
    chip.heading_deg, chip.roll_deg, chip.pitch_deg = heading_deg, roll_deg, pitch_deg
    chip.yaw_rate_deg_s = 20.0
    compass = open_bno055(CompassPart(driver="bno055", mounting=Mounting(**mounting)), clock)
    try:
        eventually(lambda: compass.read() is not None)
        assert heading_roll_pitch(compass) == pytest.approx((heading_deg, roll_deg, pitch_deg), abs=0.02)
        reading = known(compass.read())
        assert reading.yaw_rate_rad_s == pytest.approx(math.radians(20.0), abs=0.002)
    finally:
        compass.close()
