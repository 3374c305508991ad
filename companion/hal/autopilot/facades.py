"""The boat's parts behind an autopilot's line, which they share."""

import threading
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

from companion.config.boat_config import BoatConfig
from companion.core.readings import (
    BatteryReading,
    DepthReading,
    GnssFix,
    HeadingReading,
    RcReading,
    SonarReading,
)
from companion.core.status_text import StatusText
from companion.hal.autopilot.line import AutopilotLine
from companion.hal.autopilot.readings import AutopilotReadings
from companion.links.port_url import open_port, parse_port_url
from companion.links.retried import PACE, Pace, RetriedPort

Reading = TypeVar("Reading")


class _Part:
    """closes: called once, at the first `close`."""

    def __init__(self, line: AutopilotLine, closes: Callable[[], None]) -> None:
        self._line = line
        self._closes: Callable[[], None] | None = closes

    def take_texts(self) -> list[StatusText]:
        return self._line.link.take_texts()

    def close(self) -> None:
        closes, self._closes = self._closes, None
        if closes is not None:
            closes()


class AutopilotSensor(_Part, Generic[Reading]):
    """Satisfies `Sensor` with one of the readings."""

    def __init__(
        self,
        line: AutopilotLine,
        closes: Callable[[], None],
        latest: Callable[[AutopilotReadings], Reading | None],
    ) -> None:
        super().__init__(line, closes)
        self._latest = latest

    def read(self) -> Reading | None:
        return self._latest(self._line.link.readings)


class AutopilotSonar(_Part):
    """Satisfies `Sonar`: rangers that are fixed."""

    def read(self) -> Sequence[SonarReading]:
        pings = self._line.link.readings.pings
        return [pings.popleft() for _ in range(len(pings))]

    def set_sector(self, port_rad: float, starboard_rad: float) -> None:
        """No effect."""


class AutopilotMotors(_Part):
    """Satisfies `Motors`."""

    def write(self, left: float, right: float) -> None:
        self._line.outputs.write(left, right)

    def stop(self) -> None:
        self._line.outputs.stop()


class AutopilotRudder(_Part):
    """Satisfies `Rudder`."""

    def write(self, share: float) -> None:
        self._line.outputs.write_rudder(share)


class AutopilotOutputs(_Part):
    """Satisfies `ArmedOutputs`. port: of the line, which may open later."""

    @property
    def port(self) -> RetriedPort:
        return self._line.port

    @property
    def fault(self) -> str:
        outputs = self._line.link.outputs
        return "" if outputs is None or not outputs.fault else f"autopilot {outputs.fault}"

    @property
    def settings(self) -> tuple[list[str], list[str]] | None:
        """Parameters that must be changed, and those that should be; None until they are read."""
        outputs = self._line.link.outputs
        if outputs is None or not outputs.parameters.is_complete:
            return None
        return outputs.parameters.faults(), outputs.parameters.faults(is_needed=False)

    def allow(self, *, may_drive: bool) -> None:
        if self._line.link.outputs is not None:
            self._line.link.outputs.may_drive = may_drive


_lines: dict[str, tuple[AutopilotLine, list[object]]] = {}  # open lines by url, with their users
_opening = threading.Lock()


class AutopilotParts:
    """The parts behind the autopilot of a configuration. The first opens the line, the last closes it.

    Raises ConfigError: the url is invalid.
    """

    def __init__(self, config: BoatConfig, now: Callable[[], float], pace: Pace = PACE) -> None:
        self._config, self._now, self._pace = config, now, pace
        self._url = config.parts.autopilot_part.url
        self._name = f"Autopilot {parse_port_url(self._url)}"

    def gnss(self) -> AutopilotSensor[GnssFix]:
        return AutopilotSensor(*self._use(), lambda readings: readings.fix)

    def compass(self) -> AutopilotSensor[HeadingReading]:
        return AutopilotSensor(*self._use(), lambda readings: readings.heading)

    def battery(self) -> AutopilotSensor[BatteryReading]:
        return AutopilotSensor(*self._use(), lambda readings: readings.battery)

    def depth(self) -> AutopilotSensor[DepthReading]:
        return AutopilotSensor(*self._use(), lambda readings: readings.depth)

    def rc(self) -> AutopilotSensor[RcReading]:
        return AutopilotSensor(*self._use(), lambda readings: readings.rc)

    def sonar(self) -> AutopilotSonar:
        return AutopilotSonar(*self._use())

    def motors(self) -> AutopilotMotors:
        return AutopilotMotors(*self._use())

    def rudder(self) -> AutopilotRudder:
        return AutopilotRudder(*self._use())

    def outputs(self) -> AutopilotOutputs:
        return AutopilotOutputs(*self._use())

    def _use(self) -> tuple[AutopilotLine, Callable[[], None]]:
        """The line, and how a user leaves it."""
        with _opening:
            if self._url not in _lines:
                port = RetriedPort(self._name, lambda: open_port(self._url, self._now), self._pace)
                line = AutopilotLine(port.start(), self._now, self._config)
                line.start()
                _lines[self._url] = line, []
            line, users = _lines[self._url]
            user = object()
            users.append(user)

        def leave() -> None:
            with _opening:
                users.remove(user)
                if not users:
                    del _lines[self._url]
                    line.close()

        return line, leave
