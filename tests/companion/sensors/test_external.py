"""Which of two sources of a reading counts, and events that recur."""

import pytest

from companion.config.boat_config import External
from companion.core.readings import HeadingReading
from companion.sensors.external import ExternalSensors, Use
from companion.sensors.recurrence import Recurrence

OWN, OTHER = HeadingReading(10.0, 1.0), HeadingReading(10.0, 2.0)


@pytest.mark.parametrize(
    ("use", "now_s", "expected"),
    [
        (Use.NEVER, 10.0, OWN),
        (Use.FALLBACK, 10.0, OWN),
        (Use.PREFERRED, 10.0, OTHER),
        (Use.PREFERRED, 12.0, OWN),
    ],
)
def test_a_heading_over_mavlink_counts_as_configured_while_it_is_fresh(
    use: int, now_s: float, expected: HeadingReading
) -> None:
    sensors = ExternalSensors(External())
    sensors.heading = OTHER
    assert sensors.choose_heading(OWN, External(heading=use), now_s) is expected
    assert sensors.choose_heading(None, External(heading=Use.FALLBACK), 10.0) is OTHER


def test_a_recurring_event_is_often_until_it_has_become_seldom() -> None:
    recurrence, seen = Recurrence(0.5, too_often=0.7, seldom=0.3), list[bool]()
    for happens in (True, True, False, False, True):
        recurrence.update(happens)
        seen.append(recurrence.is_often)
    assert seen == [False, True, True, False, False]
