"""The physics side of the JSON interface, without its socket: a servo packet in, a state line out."""

import math
from collections.abc import Callable

from companion.core.errors import ConfigError
from companion.core.geo import Point
from sitl.physics.json_interface import NO_ECHO_M, ServoPacket, parse_servos, sphere_offset, state_line
from sitl.world.hull_settings import LONGEST_STEP_S
from sitl.world.scenario import Scenario
from sitl.world.truth import Truth
from sitl.world.world import World

CHANNELS = 16
_AHEAD_RAD = math.radians(10.0)  # a ping this near to the bow is what a fixed ranger would have heard
_STALE_S = 3.0
_DRIVEN = 0.02  # 10 µs of pulse: a trim that is a little off its centre drives nothing
_CAST_OFF_S = 0.1  # of drive: five times ArduPilot's pulses at its start, and nothing beside a voyage


class Backend:
    """Steps one world in lockstep with the other side: time passes here only when a new frame comes.

    A frame that comes twice is answered twice and stepped once, because the answer was lost. A frame count
    that falls means that the other side restarted; the world restarts, too. record: receives each step's
    truth.

    The boat is moored, and its motors stand still, until they are first driven, because an autopilot takes a
    minute to start. While ArduPilot starts, its outputs mean nothing: some are at 1000 µs, full astern, for
    two seconds, then output 1 alone, or 1 and 3, for 20 ms. Like an electronic speed controller, this side
    waits for both outputs to have been in the middle; then both must have a pulse, and one of them drive, for
    _CAST_OFF_S.
    """

    def __init__(
        self,
        scenario: Scenario,
        left: int = 1,
        right: int = 3,
        record: Callable[[Truth], object] | None = None,
    ) -> None:
        """left, right: which servo outputs drive the motors, counted from 1 (SERVOn_FUNCTION 73 and 74).

        Raises ConfigError: no such output, or the same for both.
        """
        for name, channel in (("left", left), ("right", right)):
            if not 1 <= channel <= CHANNELS:
                raise ConfigError(f"--{name} {channel}: expected a servo output from 1 to {CHANNELS}")
        if left == right:
            raise ConfigError(f"--left {left} and --right {right}: expected two different servo outputs")
        self.steps = self.restarts = 0
        self.ignored = 0  # datagrams that are no servo packet
        self._scenario = scenario
        self._left, self._right = left, right
        self._record = record
        self._frame: int | None = None
        self._reply = b""
        self._moor()

    def _moor(self) -> None:
        """Begin with a new world."""
        self.world = World(self._scenario)
        self.world.hold_position()
        self._is_moored = True
        self._has_rested = False  # both outputs have been in the middle
        self._driven = 0  # frames in which a motor was driven, without a pause
        self._range_m = None if self.world.hardware.sonar is None else NO_ECHO_M
        self._heard_s = -math.inf

    def handle(self, data: bytes) -> bytes | None:
        """Answer one datagram; None where it is none of ours."""
        packet = parse_servos(data)
        if packet is None:
            self.ignored += 1
            return None
        if packet.frame == self._frame:
            return self._reply
        if self._frame is None:
            self._has_rested = packet.frame > 0  # this side has started late or again: the other is at work
        elif packet.frame < self._frame:
            self.restarts += 1
            self._moor()
        self._frame = packet.frame
        self._driven = self._driven + 1 if self._is_driven(packet) else 0
        if self._is_moored and self._driven >= max(1, _CAST_OFF_S * packet.rate_hz):
            self._is_moored = False
            self.world.release()
        if not self._is_moored:
            self.world.hardware.motors.write(packet.share(self._left), packet.share(self._right))
        self._advance(1.0 / packet.rate_hz)
        return self._reply

    def _is_driven(self, packet: ServoPacket) -> bool:
        """Whether an autopilot that has started drives a motor."""
        if not (packet.has_pulse(self._left) and packet.has_pulse(self._right)):
            return False
        is_in_the_middle = max(abs(packet.share(self._left)), abs(packet.share(self._right))) <= _DRIVEN
        self._has_rested = self._has_rested or is_in_the_middle
        return self._has_rested and not is_in_the_middle

    def _advance(self, dt_s: float) -> None:
        """One frame, in as many steps as the hull's integrator needs."""
        parts = max(1, math.ceil(dt_s / LONGEST_STEP_S - 1e-9))
        for _ in range(parts):
            before = self.world.truth
            now = self.world.step(dt_s / parts)
            self.steps += 1
            self._listen(now.time_s)
            if self._record is not None:
                self._record(now)
        frame = self._scenario.frame
        at = sphere_offset(frame.origin, frame.to_global(Point(now.north_m, now.east_m)))
        self._reply = state_line(now, before, at, self._range_m)

    def _listen(self, now_s: float) -> None:
        sonar = self.world.hardware.sonar
        if sonar is None:
            return
        for ping in sonar.read():
            if abs(ping.bearing_rad) <= _AHEAD_RAD:
                self._range_m = NO_ECHO_M if ping.range_m is None else ping.range_m
                self._heard_s = ping.time_s
        if now_s - self._heard_s > _STALE_S:
            self._range_m = NO_ECHO_M
