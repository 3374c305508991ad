"""Tidal streams, against the astronomical arguments worked out by Meeus's mean longitudes."""

import math
from pathlib import Path

import numpy as np
import pytest

from companion.core.geo import LatLon, LocalFrame
from mission_tools.costs.current import Current
from mission_tools.costs.current_source import open_current
from mission_tools.costs.departure import posix_s
from mission_tools.errors import MapError

pytest.importorskip("utide")
FRAME = LocalFrame(LatLon(50.0, -1.2))
DAY_S = 86400.0
RATES_DEG_H = {"M2": 28.9841042, "S2": 30.0, "N2": 28.4397295, "K1": 15.0410686, "O1": 13.9430356}
"""Published: Schureman 1958, table 2."""


def opened(path: Path, name: str, more: str = "", to_deg: float = 0.0, phase_deg: float = 0.0) -> Current:
    file = path / "tide.toml"
    lines = f'[[tide]]\nname = "{name}"\nspeed_m_s = 1.0\nto_deg = {to_deg}\nphase_deg = {phase_deg}\n'
    file.write_text(lines + more)
    return open_current(str(file), FRAME)


def along(current: Current, time_s: np.ndarray[tuple[int], np.dtype[np.float64]]) -> tuple[float, ...]:
    north, east = current.at(np.zeros_like(time_s), np.zeros_like(time_s), time_s)
    return tuple(north.tolist()) + tuple(east.tolist())


def argument_deg(name: str, time_s: float) -> float:
    """At Greenwich, without nodal corrections: mean longitudes of Meeus, chapters 25 and 47."""
    day = (time_s - posix_s("2000-01-01T12:00Z")) / DAY_S
    hour_deg = 360.0 * (time_s % DAY_S) / DAY_S + 180.0
    moon, sun = 218.3164477 + 13.17639648 * day, 280.46646 + 0.98564736 * day
    perigee = 83.3532465 + 0.11140353 * day
    return {
        "M2": 2.0 * (hour_deg - moon + sun),
        "S2": 2.0 * hour_deg,
        "N2": 2.0 * hour_deg - 3.0 * moon + 2.0 * sun + perigee,
        "K1": hour_deg + sun - 90.0,
        "O1": hour_deg - 2.0 * moon + sun + 90.0,
    }[name]


@pytest.mark.parametrize("name", RATES_DEG_H)
def test_the_strongest_flood_comes_at_its_greenwich_phase(tmp_path: Path, name: str) -> None:
    current = opened(tmp_path, name, phase_deg=70.0)
    time_s = posix_s("2026-06-01T00:00Z") + np.arange(0.0, 2.0 * DAY_S, 60.0)
    north = np.array(along(current, time_s)[: len(time_s)])
    strongest_s = float(time_s[np.argmax(north)])
    off_deg = (argument_deg(name, strongest_s) - 70.0 + 180.0) % 360.0 - 180.0
    nodal_deg = {"M2": 2.2, "S2": 0.3, "N2": 2.2, "K1": 9.0, "O1": 11.0}[name]  # at most, in 18.6 years
    assert abs(off_deg) < nodal_deg + 0.5
    assert north.max() == pytest.approx(1.0, abs={"M2": 0.04, "S2": 0.01, "N2": 0.04}.get(name, 0.2))


@pytest.mark.parametrize("name", RATES_DEG_H)
def test_it_swings_at_the_published_speed_over_midnight_and_months(tmp_path: Path, name: str) -> None:
    current = opened(tmp_path, name)
    begin_s, swing_s = posix_s("2026-06-01T23:00Z"), 3600.0 * 360.0 / RATES_DEG_H[name]
    for swings in (1, 4, 60):
        at = along(current, np.array([begin_s])), along(current, np.array([begin_s + swings * swing_s]))
        assert at[0] == pytest.approx(at[1], abs=0.02)


def test_an_ellipse_turns_anticlockwise_a_quarter_after_its_strongest_flood(tmp_path: Path) -> None:
    current = opened(tmp_path, "S2", "minor_m_s = 0.4\n", to_deg=90.0)  # the sun's: strongest at noon
    noon_s = posix_s("2026-06-01T12:00Z")
    north, east = np.split(np.array(along(current, noon_s + np.array([0.0, 3.0, 6.0]) * 3600.0)), 2)
    assert east == pytest.approx([1.0, 0.0, -1.0], abs=0.02)
    assert north == pytest.approx([0.0, 0.4, 0.0], abs=0.02)


def test_constituents_add_up_with_a_steady_stream_on_one_clock(tmp_path: Path) -> None:
    one, both = opened(tmp_path, "M2", to_deg=90.0), None
    time_s = posix_s("2026-06-01T05:00Z") + np.zeros(1)
    first = along(one, time_s)
    steady = "speed_m_s = 0.3\nto_deg = 0.0\n"
    (tmp_path / "sum.toml").write_text(steady + (tmp_path / "tide.toml").read_text())
    both = open_current(str(tmp_path / "sum.toml"), FRAME)
    assert along(both, time_s) == pytest.approx((0.3, first[1]))
    assert both.times == (-math.inf, math.inf, True)
    (tmp_path / "flow.csv").write_text(
        "east_m,north_m,current_east_m_s,current_north_m_s,time_s\n0,0,0,0,0\n0,0,1,1,9\n"
    )
    (tmp_path / "sum.toml").write_text('file = "flow.csv"\n' + (tmp_path / "tide.toml").read_text())
    with pytest.raises(MapError, match=r"sum\.toml: some of its parts have dates and others seconds"):
        open_current(str(tmp_path / "sum.toml"), FRAME)


@pytest.mark.parametrize(
    ("name", "more", "message"),
    [
        ("M9", "", r"tide\.toml: no tidal constituent M9: expected names such as M2"),
        ("M2", "minor_m_s = 99\n", "minor_m_s"),
        ("M2", "speed = 1\n", "speed"),
    ],
)
def test_constants_that_make_no_sense_are_refused(tmp_path: Path, name: str, more: str, message: str) -> None:
    with pytest.raises(MapError, match=message):
        opened(tmp_path, name, more)


def test_without_the_library_it_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "utide", None)
    with pytest.raises(MapError, match=r"needs utide, which is not installed: .*\[tide\]"):
        opened(tmp_path, "M2")
