"""What --depart takes, and how times are said."""

import pytest

from mission_tools.costs.departure import Departure, KnownTimes, iso, posix_s, time_said
from mission_tools.errors import UsageError

EIGHT_S = 1780300800.0  # date -u -d 2026-06-01T08:00Z +%s
DATED, SECONDS = KnownTimes(EIGHT_S, EIGHT_S + 3600.0, is_dated=True), KnownTimes(0.0, 3600.0)


@pytest.mark.parametrize(
    "text", ["2026-06-01T08:00Z", "2026-06-01 08:00", "2026-06-01T10:00+02:00", " 2026-06-01T08:00:00Z "]
)
def test_a_date_is_seconds_since_1970(text: str) -> None:
    assert Departure.of(text, DATED) == Departure(EIGHT_S, EIGHT_S, is_dated=True)
    assert iso(posix_s(text)) == "2026-06-01T08:00:00Z"


def test_a_window_has_two_ends() -> None:
    assert Departure.of("600..1200.5", SECONDS) == Departure(600.0, 1200.5)
    found = Departure.of("2026-06-01T08:00Z..2026-06-01T20:00Z", DATED)
    assert (found.begin_s, found.latest_s, found.is_window) == (EIGHT_S, EIGHT_S + 43200.0, True)
    assert not Departure.of("600", SECONDS).is_window


def test_without_a_departure_the_clock_begins_at_zero() -> None:
    assert Departure.of(None, None) == Departure.of(None, SECONDS) == Departure()
    assert Departure.of("2026-06-01T08:00Z", None).is_dated


@pytest.mark.parametrize(
    ("text", "times", "message"),
    [
        ("soon", SECONDS, "expected 2026-06-01T08:00Z"),
        ("nan", SECONDS, "expected 2026"),
        ("", SECONDS, "expected 2026"),
        ("9..3", SECONDS, "the later is last"),
        ("3..2026-06-01", SECONDS, "two dates, or two numbers"),
        ("3..5", None, "does not change"),
        ("3", DATED, "expected a date"),
        ("2026-06-01", SECONDS, "seconds on the clock"),
        (None, DATED, r"2026-06-01T08:00:00Z to 2026-06-01T09:00:00Z\): add --depart"),
        (None, KnownTimes(is_dated=True), "with time: add --depart"),
    ],
)
def test_a_departure_that_makes_no_sense_is_refused(
    text: str | None, times: KnownTimes, message: str
) -> None:
    with pytest.raises(UsageError, match=message):
        Departure.of(text, times)


def test_a_voyage_beyond_the_known_times_is_noted() -> None:
    assert DATED.note(EIGHT_S, EIGHT_S + 3600.0) == KnownTimes().note(-1e9, 1e9) == ()
    known = "2026-06-01 08:00Z to 2026-06-01 09:00Z"
    said = f"the current is known from {known} only: beyond, it counts as it is then"
    assert DATED.note(EIGHT_S - 1.0, EIGHT_S) == DATED.note(EIGHT_S, EIGHT_S + 3601.0) == (said,)


def test_times_are_said_as_dates_or_durations() -> None:
    assert time_said(EIGHT_S + 29.0, is_dated=True) == "2026-06-01 08:00Z"
    assert time_said(3700.0, is_dated=False) == "1 h 01 min"
