"""The whole boat in simulated water; its motor commands pass the real bridge driver over mock pins."""

import contextlib

from boat_rig import OK, Rig
from mock_pi import PINS, MockPi

from companion.boat import TICK_S
from companion.hal.interfaces import Motors
from companion.hal.motors.bridges import BridgeMotors, open_bridges
from companion.hal.motors.watched_motors import WatchedMotors

LOOK_S = 0.125  # how often the motors' watch looks: four times in its time-out of 0.5 s


class DriverError(OSError):
    """What a driver raises here."""


class Bridge:
    """The bridge driver, which can be broken, with the emulated motors turning as its pins say."""

    def __init__(self, pi: MockPi) -> None:
        self.now_s = 0.0
        self.breaks: set[str] = set()  # which of write, stop and close raise before they reach a pin
        self.turning: Motors | None = None
        self.closed_s: float | None = None
        self._driver: BridgeMotors = open_bridges(PINS, lambda: self.now_s, pi.factory)

    def write(self, left: float, right: float) -> None:
        self._break("write")
        self._driver.write(left, right)
        if self.turning is not None:
            self.turning.write(left, right)

    def stop(self) -> None:
        self._break("stop")
        self._driver.stop()
        if self.turning is not None:
            self.turning.stop()

    def close(self) -> None:
        self._break("close")
        self._driver.close()
        if self.turning is not None:
            self.turning.stop()

    def _break(self, what: str) -> None:
        if what in self.breaks:
            raise DriverError(f"{what}: the wire has come off")


class PinnedBoat:
    """A boat under way in open water with a station, and its motors' watch at work."""

    def __init__(self) -> None:
        self.pi = MockPi()
        self.bridge = Bridge(self.pi)
        self.motors = WatchedMotors(self.bridge, lambda: self.bridge.now_s, 0.5)
        self.rig = Rig(motors=self.motors, cutoff=self.motors)
        self.bridge.turning = self.rig.world.hardware.motors
        self._look_s = 0.0

    def sail(self) -> None:
        """Armed in GUIDED, and on its way north."""
        self.rig.ready()
        assert self.rig.set_mode(15) == OK
        assert self.rig.arm() == OK
        self.rig.peer.command_int(192, -1, 1, 0, 0, x=500_020_000, y=-12_000_000)
        self.run(5.0)
        assert self.pi.is_driving
        assert self.rig.world.truth.surge_m_s > 1.0

    def step(self, *, hangs: bool = False) -> None:
        """One tick of the boat, unless its loop hangs, and of the water; the watch looks when it is due."""
        self.bridge.now_s = self.rig.now_s
        if not hangs:
            self.rig.boat.step(self.rig.now_s)
        self.rig.world.step(TICK_S)
        self.bridge.now_s = self.rig.now_s
        if self.rig.now_s >= self._look_s:
            self._look_s = self.rig.now_s + LOOK_S
            with contextlib.suppress(DriverError):  # the thread tries again at its next look
                self.motors.watch()

    def run(self, seconds: float) -> None:
        """Simulated time goes by."""
        for _ in range(round(seconds / TICK_S)):
            self.step()

    def off_after_s(self, limit_s: float, *, hangs: bool = False) -> float:
        """How long the motors still get current; fails beyond limit_s, or if they start again."""
        began_s = self.rig.now_s
        while self.pi.is_driving:
            assert self.rig.now_s - began_s < limit_s + 1e-9, f"still driving after {limit_s} s"
            self.step(hangs=hangs)
        took_s = self.rig.now_s - began_s
        for _ in range(100):
            self.step(hangs=hangs)
            assert not self.pi.is_driving, "the motors have started again"
        return took_s
