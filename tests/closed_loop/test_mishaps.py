"""Whole missions with one mishap on the way, as the random campaigns draw them, against the truth."""

import pytest
from boat_rig import HOME_ITEM, scenario, waypoint

from sitl.sail import Result, Sailing

CURRENT = ("environment.current_m_s=0.5", "environment.current_to_deg=90.0")


def sail(fault: str, *settings: str, linger_s: float = 0.0) -> tuple[Sailing, Result]:
    """Forty metres out and sixty across, with a fault."""
    items = [HOME_ITEM, waypoint(40.0, 0.0), waypoint(40.0, 60.0)]
    sailing = Sailing(scenario("open", *CURRENT, f"faults=[{{{fault}}}]", *settings), items)
    return sailing, sailing.run(linger_s=linger_s)


def said(sailing: Sailing) -> list[str]:
    return [event.text for event in sailing.timeline.events if event.kind == "text"]


@pytest.mark.parametrize("size", [2.0, 4.0])
def test_a_loop_that_hangs_finds_the_boat_again_at_the_next_fixes(size: float) -> None:
    sailing, result = sail(f"what='clock', kind='wrong', size={size}, at_s=15.0")
    assert result.completed
    assert result.cross_track_max_m is not None
    assert result.cross_track_max_m < 4.0
    nav = sailing.lockstep.boat.nav
    assert nav is not None
    assert not nav.faults
