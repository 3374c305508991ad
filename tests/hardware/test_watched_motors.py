"""The watch over the motors: a loop that hangs leaves them off."""

import threading

import pytest

from companion.hal.watched_motors import WatchedMotors


class RecordingMotors:
    """Remembers every call."""

    def __init__(self) -> None:
        self.calls: list[tuple[str, float, float]] = []
        self.stopped = threading.Event()

    def write(self, left: float, right: float) -> None:
        self.calls.append(("write", left, right))

    def stop(self) -> None:
        self.calls.append(("stop", 0.0, 0.0))
        self.stopped.set()

    def close(self) -> None:
        self.calls.append(("close", 0.0, 0.0))


class Clock:
    now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def motors() -> RecordingMotors:
    return RecordingMotors()


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_motors_whose_command_has_grown_old_are_stopped_once(motors: RecordingMotors, clock: Clock) -> None:
    watched = WatchedMotors(motors, clock, timeout_s=0.5)
    watched.write(0.4, -0.2)
    clock.now_s += 0.5
    watched.watch()
    assert motors.calls == [("write", 0.4, -0.2)]
    clock.now_s += 0.01
    watched.watch()
    clock.now_s += 10.0
    watched.watch()
    assert motors.calls == [("write", 0.4, -0.2), ("stop", 0.0, 0.0)]
    assert watched.trips == 1


def test_a_loop_that_goes_on_commanding_is_left_alone(motors: RecordingMotors, clock: Clock) -> None:
    watched = WatchedMotors(motors, clock, timeout_s=0.5)
    for _ in range(100):
        watched.write(1.0, 1.0)
        clock.now_s += 0.4
        watched.watch()
    assert watched.trips == 0


@pytest.mark.parametrize("rest", ["zero", "stop"])
def test_motors_at_rest_are_not_watched(motors: RecordingMotors, clock: Clock, rest: str) -> None:
    watched = WatchedMotors(motors, clock, timeout_s=0.5)
    watched.write(0.4, 0.4)
    if rest == "zero":
        watched.write(0.0, 0.0)
    else:
        watched.stop()
    clock.now_s += 60.0
    watched.watch()
    assert watched.trips == 0


def test_a_loop_that_comes_back_drives_again(motors: RecordingMotors, clock: Clock) -> None:
    watched = WatchedMotors(motors, clock, timeout_s=0.5)
    watched.write(0.4, 0.4)
    clock.now_s += 1.0
    watched.watch()
    watched.write(0.4, 0.4)
    clock.now_s += 0.1
    watched.watch()
    assert motors.calls[-1] == ("write", 0.4, 0.4)


@pytest.mark.realtime
def test_the_thread_looks_without_being_asked(motors: RecordingMotors) -> None:
    ticks = iter(range(1_000_000))
    watched = WatchedMotors(motors, lambda: float(next(ticks)), timeout_s=0.02)
    watched.start()
    watched.write(0.3, 0.3)
    assert motors.stopped.wait(5.0)
    watched.close()
    watched.close()
    assert motors.calls.count(("stop", 0.0, 0.0)) == 1
