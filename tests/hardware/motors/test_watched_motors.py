"""The watch over the motors: a loop that hangs leaves them off."""

import threading

import pytest
from patience import MOMENT_S

from companion.hal.motors.watched_motors import WatchedMotors


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


class StickingMotors(RecordingMotors):
    """Every way of switching off raises so many times before it works."""

    def __init__(self, failures: int) -> None:
        super().__init__()
        self._is_on = False
        self._failures = failures

    def write(self, left: float, right: float) -> None:
        if left or right:
            self._is_on = True
        else:
            self._switch_off()
        super().write(left, right)

    def stop(self) -> None:
        self._switch_off()
        super().stop()

    def close(self) -> None:
        self._switch_off()
        super().close()

    def is_on(self) -> bool:
        return self._is_on

    def _switch_off(self) -> None:
        if self._failures:
            self._failures -= 1
            raise OSError("the bus does not answer")
        self._is_on = False


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
    assert watched.watch() == 0.125  # it looks four times in its time-out
    assert motors.calls == [("write", 0.4, -0.2)]
    clock.now_s += 0.01
    watched.watch()
    clock.now_s += 10.0
    watched.watch()
    assert motors.calls == [("write", 0.4, -0.2), ("stop", 0.0, 0.0)]
    assert watched.trips == 1


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


def test_a_driver_that_raises_while_the_watch_stops_it_is_asked_again(clock: Clock) -> None:
    motors = StickingMotors(failures=3)
    watched = WatchedMotors(motors, clock, timeout_s=0.5)
    watched.write(0.4, 0.4)
    clock.now_s += 0.6
    for _ in range(3):
        with pytest.raises(OSError, match="does not answer"):
            watched.watch()
    assert motors.is_on()
    watched.watch()
    assert not motors.is_on()
    assert watched.trips == 1


@pytest.mark.parametrize("way", ["stop", "close", "write"])
def test_motors_that_could_not_be_stopped_stay_watched(clock: Clock, way: str) -> None:
    motors = StickingMotors(failures=1)
    watched = WatchedMotors(motors, clock, timeout_s=0.5)
    watched.write(0.4, 0.4)
    with pytest.raises(OSError, match="does not answer"):
        getattr(watched, way)(*((0.0, 0.0) if way == "write" else ()))
    assert motors.is_on()
    clock.now_s += 0.6
    watched.watch()
    assert not motors.is_on()


@pytest.mark.realtime
def test_the_thread_looks_without_being_asked(motors: RecordingMotors) -> None:
    ticks = iter(range(1_000_000))
    watched = WatchedMotors(motors, lambda: float(next(ticks)), timeout_s=0.02)
    watched.start()
    watched.write(0.3, 0.3)
    assert motors.stopped.wait(MOMENT_S)
    watched.close()
    watched.close()
    assert motors.calls.count(("stop", 0.0, 0.0)) == 1
