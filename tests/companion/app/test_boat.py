import dataclasses
from itertools import pairwise

import pytest
from boat_rig import OK, FakeBattery, Rig, Silent

from companion.core.readings import HeadingReading
from companion.failsafe.table import Condition
from companion.mavlink.dialect import dialect


class Recorded:
    """Motors that remember every write."""

    def __init__(self) -> None:
        self.history: list[tuple[float, float]] = []
        self.closed = 0

    def write(self, left: float, right: float) -> None:
        """Remember."""
        self.history.append((left, right))

    def stop(self) -> None:
        """Remember."""
        self.history.append((0.0, 0.0))

    def close(self) -> None:
        """Count."""
        self.stop()
        self.closed += 1


def driving(rig: Rig) -> None:
    """Armed, in MANUAL, half ahead."""
    rig.ready()
    assert rig.set_mode(0) == OK
    assert rig.arm() == OK
    for _ in range(10):
        rig.peer.send(dialect.MAVLink_manual_control_message(1, 0, 0, 500, 0, 0))
        rig.step(5)


def test_the_motors_get_a_command_each_tick_and_none_before_arming() -> None:
    motors = Recorded()
    rig = Rig(motors=motors)
    rig.run(10.0)
    assert motors.history == [(0.0, 0.0)] * 500


def test_the_motors_follow_the_hand_and_no_faster_than_the_slew_rate() -> None:
    motors = Recorded()
    rig = Rig(motors=motors)
    driving(rig)
    assert motors.history[-1] == pytest.approx((0.5, 0.5))
    steps = [abs(after[0] - before[0]) for before, after in pairwise(motors.history)]
    assert max(steps) <= rig.config.motors.slew_per_s * 0.02 + 1e-9


def test_a_disarm_between_two_ticks_stops_the_motors_at_once() -> None:
    motors = Recorded()
    rig = Rig(motors=motors)
    driving(rig)
    writes = len(motors.history)
    rig.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0, 21196.0)
    assert motors.history[writes:] == [(0.0, 0.0)]
    rig.run(1.0)
    assert set(motors.history[writes:]) == {(0.0, 0.0)}


def test_closing_stops_the_motors_and_may_be_done_twice() -> None:
    motors = Recorded()
    rig = Rig(motors=motors)
    driving(rig)
    rig.boat.close()
    rig.boat.close()
    assert motors.history[-1] == (0.0, 0.0)
    assert motors.closed == 2
    rig.peer.listen()
    assert rig.peer.link.is_closed


def under_way_to_the_north() -> Rig:
    rig = Rig().ready()
    rig.set_mode(15)
    rig.arm()
    rig.peer.command_int(192, -1, 1, 0, 0, x=500_010_000, y=-12_000_000)
    rig.run(5.0)
    assert rig.world._motors.left > 0.1
    return rig


def test_a_boat_whose_compass_falls_silent_goes_on_by_its_course() -> None:
    rig = under_way_to_the_north()
    stuck = Stuck(rig.hardware.compass.read())
    rig.boat.sensors._hardware = dataclasses.replace(rig.hardware, compass=stuck)
    rig.run(20.0)
    assert "Failsafe: Compass lost: using gyro and course" in rig.peer.texts
    assert rig.mode == "GUIDED"
    assert rig.world.truth.north_m > 30.0
    assert abs(rig.world.truth.east_m) < 2.0


def test_without_compass_and_course_the_motors_stop() -> None:
    rig = under_way_to_the_north()
    rig.boat.sensors._hardware = dataclasses.replace(
        rig.hardware, compass=Stuck(rig.hardware.compass.read()), gnss=Silent()
    )
    rig.run(rig.config.motors.estimate_timeout_s + 1.3)
    assert "Failsafe: Heading lost" in rig.peer.texts
    assert rig.mode == "HOLD"
    assert rig.boat.guidance.helm.heading_pid is None  # an open loop learns nothing and tells nothing
    assert (rig.world._motors.left, rig.world._motors.right) == (0.0, 0.0)


class Stuck:
    """A compass that goes on handing out the same reading."""

    def __init__(self, reading: HeadingReading | None) -> None:
        self._reading = reading

    def read(self) -> HeadingReading | None:
        """The same again."""
        return self._reading

    def close(self) -> None:
        """Nothing to let go."""


def test_a_boat_without_receiver_can_still_be_driven_by_hand() -> None:
    rig = Rig(gnss=Silent())
    rig.run(2.0)
    assert rig.set_mode(15) != OK
    assert rig.set_mode(0) == OK
    assert rig.arm() == OK
    rig.peer.send(dialect.MAVLink_manual_control_message(1, 0, 0, 800, 0, 0))
    rig.run(0.5)
    assert rig.world._motors.left == pytest.approx(0.8)


def test_a_low_pack_brings_the_boat_home_after_its_time() -> None:
    battery = FakeBattery(12.0)
    rig = Rig(battery=battery).ready()
    rig.set_mode(15)
    rig.arm()
    rig.run(1.0)
    battery.voltage_v = 9.9
    took_s = rig.until(lambda: rig.mode == "RTL", 20.0)
    assert took_s == pytest.approx(rig.config.failsafe.battery_low_s, abs=0.1)
    rig.step()
    assert any("Battery low: 9.9 V" in text for text in rig.peer.texts)


def test_an_operator_who_falls_silent_is_missed_and_the_planner_does_not_stand_in() -> None:
    rig = Rig().ready()
    rig.set_mode(15)
    rig.arm()
    for second in range(12):
        if second < 3:
            rig.peer.heartbeat()
        rig.peer.heartbeat(dialect.MAV_TYPE_ONBOARD_CONTROLLER)
        rig.run(1.0)
        assert rig.mode == ("GUIDED" if second < 7 else "LOITER")


def test_equal_seeds_give_equal_bytes_and_another_seed_gives_others() -> None:
    def told(seed: int) -> bytes:
        rig = Rig("open", f"seed={seed}")
        rig.run(20.0)
        return b"".join(rig.peer.link.receive())

    assert told(1) == told(1)
    assert told(1) != told(2)


def test_failsafes_wait_for_a_second_and_a_half_after_a_leap_of_the_clock() -> None:
    rig = Rig()
    rig.peer.heartbeat()
    rig.run(1.0)
    began_s, lost = rig.now_s + 8.0, []
    for tick in range(100):
        rig.boat.step(began_s + 0.02 * tick)
        lost.append(rig.boat.vehicle.failsafes.is_active(Condition.OPERATOR_LOST))
    assert 0.02 * lost.index(True) == pytest.approx(1.5, abs=0.05)


def test_a_program_whose_ticks_take_more_than_a_second_goes_on_judging_its_failsafes() -> None:
    rig = Rig()
    rig.peer.heartbeat()
    rig.run(1.0)
    for tick in range(1, 12):
        rig.boat.step(rig.now_s + 1.1 * tick)
    assert rig.boat.vehicle.failsafes.is_active(Condition.OPERATOR_LOST)


@pytest.mark.parametrize(("pause_s", "is_told"), [(0.98, False), (1.04, True)])
def test_a_tick_that_comes_more_than_a_second_late_is_told(pause_s: float, *, is_told: bool) -> None:
    rig = Rig()
    rig.run(1.0)
    rig.boat.step(rig.now_s + pause_s)
    assert any(text.startswith("Clock leapt by") for text in rig.peer.texts) is is_told
