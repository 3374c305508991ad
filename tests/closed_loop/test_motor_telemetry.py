"""A catamaran whose speed controllers report: what they add to a voyage, against one whose do not."""

import pytest
from sailing_rig import GUSTS, mission_run, said

CATAMARAN = ("boat.model='catamaran'", *GUSTS)
REPORTS = "vehicle.parts.motors.telemetry='kiss'"
WEED = "faults=[{what='motor_%s', kind='weed', size=0.12, at_s=35.0}]"
pytestmark = pytest.mark.slow


@pytest.mark.parametrize(("side", "seed"), [("left", 11), ("right", 12)])
def test_weed_is_named_within_seconds_instead_of_never(side: str, seed: int) -> None:
    notices: list[float | None] = []
    for settings in ((REPORTS,), ()):
        run = mission_run(
            (60.0, 0.0), (60.0, 60.0), settings=(*CATAMARAN, WEED % side, f"seed={seed}", *settings)
        )
        run.run(timeout_s=60.0)
        text = f"Failsafe: Weed on the {side} propeller"
        events = run.timeline.events
        notices.append(next((one.time_s - 35.0 for one in events if one.text == text), None))
    with_reports, without = notices
    assert with_reports is not None
    assert with_reports < 5.0
    assert without is None or without > 2.0 * with_reports


def test_a_healthy_voyage_raises_no_alarm() -> None:
    run = mission_run((60.0, 0.0), (60.0, 60.0), (0.0, 60.0), settings=(*CATAMARAN, REPORTS, "seed=13"))
    assert run.run().completed
    assert not [text for text in said(run) if "otor" in text or "ropeller" in text or "ESC" in text]
