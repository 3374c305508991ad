"""The declination by the world magnetic model, from the model to the heading that the boat steers by."""

import math

import pytest
from boat_rig import Rig
from twins.lines import known

from companion.core.geo import LatLon
from companion.core.readings import GnssFix, HeadingReading
from companion.core.status_text import Severity
from companion.sensors.compass.earth_field import EarthFieldModel

# NOAA's test values at sea level (WMM2025_TestValues): year, latitude, longitude, declination in degrees,
# horizontal and downward field in nT
VALUES = [
    (2025.0, 80.0, 0.0, 1.28, 6523.2, 54791.5),
    (2025.0, 0.0, 120.0, -0.16, 39677.9, -10580.2),
    (2025.0, -80.0, -120.0, 68.78, 16898.1, -52022.5),
    (2027.5, 80.0, 0.0, 2.59, 6507.5, 54869.4),
    (2027.5, 0.0, 120.0, -0.24, 39702.0, -10381.8),
    (2027.5, -80.0, -120.0, 68.49, 16908.3, -51783.7),
]
BEGIN_2025_S, YEAR_S = 1735689600.0, 365.0 * 86400.0


@pytest.mark.parametrize("row", VALUES)
def test_the_field_is_that_of_noaas_test_values(row: tuple[float, ...]) -> None:
    year, lat_deg, lon_deg, declination_deg, horizontal_nt, down_nt = row
    model = EarthFieldModel()
    model.update(LatLon(lat_deg, lon_deg), BEGIN_2025_S + (year - 2025.0) * YEAR_S)
    field = known(model.field)
    assert math.degrees(field.declination_rad) == pytest.approx(declination_deg, abs=0.006)
    assert field.horizontal_mg * 100.0 == pytest.approx(horizontal_nt, abs=0.2)
    assert field.down_mg * 100.0 == pytest.approx(down_nt, abs=0.2)


def test_the_operator_is_told_once_and_warned_after_the_models_end() -> None:
    model = EarthFieldModel()
    assert model.update(LatLon(50.0, -1.2), 0.0) == []
    assert model.field is None
    (text,) = model.update(LatLon(50.0, -1.2), BEGIN_2025_S)
    assert text == (Severity.INFO, "Compass: declination 0.7 degrees east (WMM-2025)")
    assert model.update(LatLon(51.0, -1.2), BEGIN_2025_S) == []
    late = EarthFieldModel().update(LatLon(50.0, -1.2), BEGIN_2025_S + 5.01 * YEAR_S)
    assert late[1] == (Severity.WARNING, "Compass: WMM-2025 is for 2025 to 2030; update the boat's software")


def test_the_field_is_found_anew_far_away_and_a_day_later() -> None:
    model = EarthFieldModel()
    model.update(LatLon(50.0, 179.96), BEGIN_2025_S)
    first = model.field
    model.update(LatLon(50.05, -179.98), BEGIN_2025_S + 80000.0)
    assert model.field is first
    model.update(LatLon(50.2, -179.98), BEGIN_2025_S)
    second = model.field
    assert second is not first
    model.update(LatLon(50.2, -179.98), BEGIN_2025_S + 90000.0)
    assert model.field is not second


class Part:
    """A sensor whose readings the test sets."""

    def __init__(self, reading: object) -> None:
        self.reading = reading

    def read(self) -> object:
        return self.reading

    def close(self) -> None:
        """Nothing to let go."""


def heading_deg(*, is_magnetic: bool, **config: object) -> float:
    """What the boat steers by in Vancouver (15.6° east in 2026), its compass pointing east."""
    fix = GnssFix(0.0, LatLon(49.28, -123.12), 3, 12, 0.9, unix_time_s=BEGIN_2025_S + 1.5 * YEAR_S)
    compass = Part(HeadingReading(0.0, math.radians(90.0), is_magnetic=is_magnetic))
    settings = {f"parts.compass.{key}": value for key, value in config.items()}
    rig = Rig(gnss=Part(fix), compass=compass, config=settings)
    rig.step(3)
    assert rig.boat.sensors.heading is not None
    return math.degrees(rig.boat.sensors.heading.heading_rad)


def test_a_magnetic_heading_is_turned_by_the_models_declination() -> None:
    assert heading_deg(is_magnetic=True, auto_declination=True) == pytest.approx(105.5, abs=0.5)
