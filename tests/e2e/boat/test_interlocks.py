"""Each interlock through the whole boat: what lies before it breaks, and the pins go low within its time.

The times are those of the table in docs/failsafes.md; the ways out of the program are in test_ways_out.py.
"""

import logging
import math
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from boat_rig import PLANNER, Silent
from msgspec.structs import replace
from pinned_boat import LOOK_S, DriverError, PinnedBoat

from companion.autopilot.motor_output import DISARM_LEVEL, GIVE_UP_LEVEL
from companion.autopilot.pipeline import GUIDANCE_S, GuidancePipeline
from companion.boat import TICK_S
from companion.config.boat_config import BoatConfig
from companion.control.helm import Helm
from companion.core.state import NavState, Thrust
from companion.estimation.estimator import Estimator
from companion.mavlink.dialect import dialect
from companion.services.endpoint import Endpoint
from companion.vehicle.vehicle import Vehicle

STALE_S = BoatConfig().motors.command_timeout_s + 2.0 * TICK_S
LOST_S = BoatConfig().motors.estimate_timeout_s + 1.3
HANG_S = BoatConfig().motors.command_timeout_s + LOOK_S + 2.0 * TICK_S
SAME_TICK_S = TICK_S
NAN = math.nan
STALL_TEXT = "Program stalled: motors cut off after 0.5 s"


@pytest.fixture
def boat() -> Iterator[PinnedBoat]:
    logging.disable(logging.CRITICAL)  # the faults of these tests are meant
    boat = PinnedBoat()
    yield boat
    boat.bridge.breaks.clear()
    boat.rig.boat.close()
    boat.pi.factory.reset()
    logging.disable(logging.NOTSET)


# Armed


def test_a_boat_that_is_no_longer_armed_stops_in_the_same_tick_whatever_is_steered_for(
    boat: PinnedBoat, monkeypatch: pytest.MonkeyPatch
) -> None:
    boat.sail()
    decide = Vehicle.decide
    intent = decide(boat.rig.boat.vehicle)
    monkeypatch.setattr(Vehicle, "decide", lambda _: intent)
    boat.rig.boat.vehicle.armed = False
    boat.off_after_s(SAME_TICK_S)


# A fresh decision


@pytest.mark.parametrize("what", ["guide", "is_due"])
def test_guidance_that_falls_silent_stops_the_motors(
    boat: PinnedBoat, monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    boat.sail()
    monkeypatch.setattr(GuidancePipeline, what, lambda *_: None)
    took_s = boat.off_after_s(STALE_S)
    assert took_s > STALE_S - GUIDANCE_S - 2.0 * TICK_S, "it went off for another reason"
    assert boat.rig.boat.command.reason == "command is stale"
    monkeypatch.undo()
    boat.run(1.0)
    assert boat.pi.is_driving


# A fresh estimate


def test_an_estimator_that_returns_the_same_estimate_for_ever_stops_the_motors(
    boat: PinnedBoat, monkeypatch: pytest.MonkeyPatch
) -> None:
    boat.sail()
    stuck = boat.rig.boat.nav
    monkeypatch.setattr(Estimator, "update", lambda *_: stuck)
    boat.off_after_s(STALE_S)
    assert boat.rig.boat.command.reason == "estimate is stale"


def test_receiver_and_compass_that_fall_silent_together_stop_the_motors(boat: PinnedBoat) -> None:
    boat.sail()
    senses, rig = boat.rig.boat.sensors, boat.rig
    parts = {name: getattr(rig.hardware, name) for name in ("motors", "sonar", "battery", "hull", "rc")}
    senses._hardware = type(rig.hardware)(gnss=Silent(), compass=Silent(), **parts)
    boat.run(LOST_S)  # until the heading is lost too, a failsafe may keep the bow into the current
    boat.off_after_s(0.0)


# Finite numbers


@pytest.mark.parametrize("thrust", [Thrust(NAN, 0.3), Thrust(0.3, math.inf)])
def test_a_thrust_that_is_not_a_number_stops_the_motors_in_the_same_tick(
    boat: PinnedBoat, monkeypatch: pytest.MonkeyPatch, thrust: Thrust
) -> None:
    boat.sail()
    monkeypatch.setattr(Helm, "update", lambda *_: thrust)
    boat.off_after_s(SAME_TICK_S)


@pytest.mark.parametrize("field", ["north_m", "heading_rad", "surge_m_s"])
def test_an_estimate_that_is_not_a_number_stops_the_motors_in_the_same_tick(
    boat: PinnedBoat, monkeypatch: pytest.MonkeyPatch, field: str
) -> None:
    boat.sail()
    update: Callable[..., NavState | None] = Estimator.update

    def broken(*arguments: Any) -> NavState | None:  # noqa: ANN401 — hands on whatever it is called with
        nav = update(*arguments)
        return None if nav is None else replace(nav, **{field: NAN})

    monkeypatch.setattr(Estimator, "update", broken)
    boat.off_after_s(SAME_TICK_S)


def test_an_allocation_that_makes_a_command_not_a_number_is_stopped_by_the_driver(
    boat: PinnedBoat, monkeypatch: pytest.MonkeyPatch
) -> None:
    boat.sail()

    monkeypatch.setattr("companion.autopilot.motor_output.motor_pwm", lambda *_: (NAN, 0.0))
    boat.off_after_s(SAME_TICK_S)


# The watch


def test_every_station_is_told_once_of_each_stall_that_stopped_the_motors(boat: PinnedBoat) -> None:
    boat.sail()
    other = boat.rig.connect(PLANNER)
    for stalls in (1, 2):
        boat.off_after_s(HANG_S, hangs=True)
        boat.run(5.0)
        assert boat.pi.is_driving
        for station in (boat.rig.peer, other):
            said = [one for one in station.said("STATUSTEXT") if "stalled" in str(one.text)]
            assert [str(one.text).rstrip("\0") for one in said] == [STALL_TEXT] * stalls
            assert all(one.severity <= dialect.MAV_SEVERITY_WARNING for one in said)


def test_a_loop_that_hangs_while_the_driver_raises_is_stopped_once_the_driver_answers(
    boat: PinnedBoat,
) -> None:
    boat.sail()
    boat.bridge.breaks = {"stop"}
    for _ in range(round(2.0 / TICK_S)):
        boat.step(hangs=True)
    assert boat.pi.is_driving
    boat.bridge.breaks = set()
    boat.off_after_s(LOOK_S + TICK_S, hangs=True)


# The safety net, and drivers that raise


@pytest.mark.parametrize(
    ("owner", "what"),
    [(Estimator, "update"), (Vehicle, "decide"), (GuidancePipeline, "drive"), (Endpoint, "tick")],
    ids=lambda part: getattr(part, "__name__", part),
)
def test_a_fault_anywhere_in_the_tick_stops_the_motors_in_the_same_tick(
    boat: PinnedBoat, monkeypatch: pytest.MonkeyPatch, owner: type, what: str
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise ZeroDivisionError

    boat.sail()
    monkeypatch.setattr(owner, what, fail)
    boat.step()
    assert not boat.pi.is_driving
    assert boat.rig.boat.net.faults == 1


def test_motors_that_do_not_stop_disarm_the_boat_and_are_told(boat: PinnedBoat) -> None:
    boat.sail()
    boat.bridge.breaks = {"write", "stop"}
    boat.step()
    assert boat.pi.is_driving
    assert not boat.rig.boat.vehicle.armed
    assert boat.rig.boat.net.faults == 1
    (text,) = [text for text in boat.rig.peer.texts if text.startswith("Fault in the program")]
    assert "motors do not stop: stop: the wire has come off" in text
    boat.bridge.breaks = set()
    boat.off_after_s(SAME_TICK_S)


def test_motors_that_never_stop_end_the_program_in_a_second(boat: PinnedBoat) -> None:
    boat.sail()
    boat.bridge.breaks = {"write", "stop"}
    with pytest.raises(DriverError):
        boat.run(1.5 * GIVE_UP_LEVEL * TICK_S)
    assert boat.rig.boat.net.faults == GIVE_UP_LEVEL > DISARM_LEVEL
    boat.bridge.breaks = set()
    boat.rig.boat.close()
    assert boat.pi.is_off
