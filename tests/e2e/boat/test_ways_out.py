"""Every way out of the real loop leaves the motors off: orders, signals, parts that fail."""

import logging
import os
import re
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack

import pytest
from mavutil_station import MavutilStation
from mock_pi import PINS, MockPi
from patience import MOMENT_S
from programs import until
from pymavlink.dialects.v20 import all as dialect

from companion.app.composition import run_boat
from companion.app.process import Shutdown
from companion.autopilot.motor_output import GIVE_UP_LEVEL
from companion.config.boat_config import BoatConfig, Parts
from companion.config.sensors import CompassPart, GnssPart
from companion.config.tuning import Failsafe
from companion.hal.interfaces import Hardware

pytestmark = pytest.mark.realtime

MANUAL = 0
PORT = re.compile(r"listening on tcpin:127\.0\.0\.1:(\d+)")
PARTS = Parts(motors=PINS, gnss=GnssPart(driver="nmea"), compass=CompassPart(driver="nmea"))
BUSY = Failsafe(overrun_action=0)  # the machine may be busy with other tests
CONFIG = BoatConfig(links=("tcpin:127.0.0.1:0",), parts=PARTS, failsafe=BUSY)


@pytest.fixture
def pi() -> Iterator[MockPi]:
    pi = MockPi()
    yield pi
    pi.factory.reset()


@pytest.fixture
def shutdown() -> Iterator[Shutdown]:
    """As the program installs it; the signals are the tests' own again afterwards."""
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = [signal.getsignal(number) for number in numbers]
    shutdown = Shutdown()
    shutdown.install()
    yield shutdown
    for number, handler in zip(numbers, before, strict=True):
        signal.signal(number, handler)


class Event:
    """Something that happens to the boat at a reading of its compass, once the motors turn; again: at every
    further one, too.
    """

    def __init__(self, pi: MockPi, happen: Callable[[], object], again: bool = False) -> None:
        self._again = again
        self.is_due = threading.Event()
        self.changes_before = 0
        self.readings_after = 0
        self._pi = pi
        self._happen = happen
        self._has_happened = False

    def on_read(self) -> None:
        """Called once a tick."""
        if self._has_happened:
            self.readings_after += 1
            if self._again:
                self._happen()
        elif self.is_due.is_set():
            self._has_happened = True
            self.changes_before = len(self._pi.history)
            self._happen()


def run_until_it_happens(
    pi: MockPi, event: Event, should_stop: Callable[[], bool], log: pytest.LogCaptureFixture
) -> None:
    """The real loop in this thread; in another one a station takes the boat under way by hand."""
    over = threading.Event()

    def take_the_helm() -> None:
        until(lambda: PORT.search(log.text))
        station = MavutilStation(int(PORT.findall(log.text)[-1]))
        try:
            assert station.enter(MANUAL) == dialect.MAV_RESULT_ACCEPTED
            until(lambda: station.arm() == dialect.MAV_RESULT_ACCEPTED)  # no heading in the first ticks

            def push() -> None:  # as a hand does: again and again
                station.mav.rc_channels_override_send(1, 1, 1500, 0, 1900, 0, 0, 0, 0, 0)

            until(lambda: push() or pi.is_driving)  # type: ignore[func-returns-value]
            event.is_due.set()
            until(over.is_set)
        finally:
            station.close()

    def open_parts(config: BoatConfig, now: Callable[[], float]) -> Hardware:
        return pi.hardware(config, now, event.on_read)

    with ThreadPoolExecutor(1) as pool, ExitStack() as ending:
        helm = pool.submit(take_the_helm)
        ending.callback(lambda: helm.result(MOMENT_S))
        ending.callback(over.set)
        run_boat(CONFIG, lambda: should_stop() or helm.done(), open_parts=open_parts)


def assert_went_off_at_once(pi: MockPi, event: Event) -> None:
    after = pi.history[event.changes_before :]
    assert pi.is_off
    assert event.readings_after == 0, "another tick was begun"
    assert len([change for change in after if change.value]) <= 2, "more than the tick under way was written"
    assert not pi.both_legs_were_on()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_the_loop_within_its_tick_and_the_motors_are_off(
    pi: MockPi, shutdown: Shutdown, caplog: pytest.LogCaptureFixture, number: signal.Signals
) -> None:
    caplog.set_level(logging.INFO)
    event = Event(pi, lambda: os.kill(os.getpid(), number))
    run_until_it_happens(pi, event, shutdown, caplog)
    assert shutdown.signal_number == number
    assert_went_off_at_once(pi, event)


def test_a_part_that_goes_on_failing_ends_the_loop_and_the_motors_stay_off(
    pi: MockPi, caplog: pytest.LogCaptureFixture
) -> None:
    def fail() -> None:
        raise OSError("the wire has come off")

    caplog.set_level(logging.INFO)
    event = Event(pi, fail, again=True)
    with pytest.raises(OSError, match="the wire has come off"):
        run_until_it_happens(pi, event, lambda: False, caplog)
    assert pi.is_off
    assert event.readings_after >= GIVE_UP_LEVEL - 1.0, "the loop ended before its time"
    assert not any(change.value for change in pi.history[event.changes_before :])
    assert not pi.both_legs_were_on()
