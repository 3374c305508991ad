"""The two antennas of a GNSS receiver as a heading sensor, with a compass in reserve."""

from collections.abc import Callable

from msgspec.structs import replace

from companion.core.readings import HeadingReading
from companion.core.status_text import StatusText
from companion.hal.interfaces import Compass, Gnss, ReportingPart
from companion.sensors.gnss_heading import GnssHeading
from companion.sensors.silence import fresh


class AntennaCompass:
    """Satisfies `companion.hal.interfaces.Compass`. Owns the compass in reserve."""

    def __init__(
        self, heading: GnssHeading, reserve: Compass, now: Callable[[], float], receiver: Gnss | None = None
    ) -> None:
        """receiver: None if it is not to be closed with this."""
        self._heading = heading
        self._reserve = reserve
        self._now = now
        self._receiver = receiver
        self._latest: HeadingReading | None = None
        self._combined: HeadingReading | None = None

    def read(self) -> HeadingReading | None:
        """The heading by the antennas; without a recent one, that of the compass in reserve."""
        latest, reserve, timeout_s = self._heading.latest, self._reserve.read(), self._heading.timeout_s
        if latest is not None and fresh(latest, timeout_s, self._now()):
            return self._with_field(latest, fresh(reserve, timeout_s, self._now()))
        return reserve or latest

    def _with_field(self, latest: HeadingReading, reserve: HeadingReading | None) -> HeadingReading:
        """The antennas' heading with the field of a magnetometer in reserve, which can then be calibrated."""
        if reserve is None or reserve.field_mg is None:
            return latest
        if latest is not self._latest:
            self._latest = latest
            self._combined = replace(
                latest, field_mg=reserve.field_mg, roll_rad=reserve.roll_rad, pitch_rad=reserve.pitch_rad
            )
        return self._combined or latest

    def take_texts(self) -> list[StatusText]:
        parts: tuple[object, ...] = (self._reserve, self._receiver)
        return [text for part in parts if isinstance(part, ReportingPart) for text in part.take_texts()]

    def close(self) -> None:
        """Release the compass in reserve, and the receiver if it is owned. May be called twice."""
        self._reserve.close()
        if self._receiver is not None:
            self._receiver.close()
