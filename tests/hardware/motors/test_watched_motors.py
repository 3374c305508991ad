"""The watch over the motors: a loop that hangs leaves them off."""

import threading

import pytest
from patience import MOMENT_S
from twins.lines import HandClock

from companion.hal.motors.watched_motors import WatchedMotors


class RecordingMotors:
    """Remembers every call. failures: so often switching off raises before it works."""

    def __init__(self, failures: int = 0) -> None:
        self.calls: list[tuple[str, float, float]] = []
        self.stopped = threading.Event()
        self._is_on = False
        self._failures = failures

    def write(self, left: float, right: float) -> None:
        self._switch(bool(left or right))
        self.calls.append(("write", left, right))

    def stop(self) -> None:
        self._switch(False)
        self.calls.append(("stop", 0.0, 0.0))
        self.stopped.set()

    def close(self) -> None:
        self._switch(False)

    def _switch(self, is_on: bool) -> None:
        if not is_on and self._failures:
            self._failures -= 1
            raise OSError("the bus does not answer")
        self._is_on = is_on

    def is_on(self) -> bool:
        return self._is_on


def test_motors_whose_command_has_grown_old_are_stopped_once(clock: HandClock) -> None:
    motors = RecordingMotors()
    watched = WatchedMotors(motors, clock, timeout_s=0.5)
    watched.write(0.4, -0.2)
    clock.advance(0.5)
    assert watched.watch() == 0.125  # it looks four times in its time-out
    assert motors.calls == [("write", 0.4, -0.2)]
    for wait_s in (0.01, 10.0):
        clock.advance(wait_s)
        watched.watch()
    assert motors.calls == [("write", 0.4, -0.2), ("stop", 0.0, 0.0)]
    assert watched.trips == 1


@pytest.mark.parametrize("rest", ["zero", "stop"])
def test_motors_at_rest_are_not_watched(clock: HandClock, rest: str) -> None:
    watched = WatchedMotors(RecordingMotors(), clock, timeout_s=0.5)
    watched.write(0.4, 0.4)
    if rest == "zero":
        watched.write(0.0, 0.0)
    else:
        watched.stop()
    clock.advance(60.0)
    watched.watch()
    assert watched.trips == 0


@pytest.mark.parametrize("way", ["watch", "stop", "close", "write"])
def test_motors_that_could_not_be_stopped_stay_watched(clock: HandClock, way: str) -> None:
    motors = RecordingMotors(failures=1)
    watched = WatchedMotors(motors, clock, timeout_s=0.5)
    watched.write(0.4, 0.4)
    clock.advance(0.6 if way == "watch" else 0.0)
    with pytest.raises(OSError, match="does not answer"):
        getattr(watched, way)(*((0.0, 0.0) if way == "write" else ()))
    assert motors.is_on()
    clock.advance(0.6)
    watched.watch()
    assert not motors.is_on()
    assert watched.trips == 1


@pytest.mark.realtime
def test_the_thread_looks_without_being_asked() -> None:
    ticks, motors = iter(range(1_000_000)), RecordingMotors()
    watched = WatchedMotors(motors, lambda: float(next(ticks)), timeout_s=0.02)
    watched.start()
    watched.write(0.3, 0.3)
    assert motors.stopped.wait(MOMENT_S)
    watched.close()
    watched.close()
    assert motors.calls.count(("stop", 0.0, 0.0)) == 1
