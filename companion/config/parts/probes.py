"""Configuration of the probes: `[[probe]]` tables."""

import re
from collections.abc import Sequence
from typing import Annotated, Literal

from msgspec import Meta

from companion.config.board import I2cBus
from companion.config.section import Positive, Section

_NAME = r"^[!-~]{1,10}$"  # what NAMED_VALUE_FLOAT can carry
_UNIT = r"^[!-~]{0,16}$"


class ProbePart(Section, frozen=True):
    """A further number to send and log: an input of an ADS1115, a serial line, or a file such as that of a
    DS18B20 thermometer. Its value is scale times what the source says, plus offset.

    column: of the text's words, from 0, separated by commas, semicolons or spaces; pattern: a regular
    expression whose first group is the number. Without either, the text is a number.
    """

    name: Annotated[str, Meta(pattern=_NAME)]
    driver: Literal["ads1115", "serial", "file"]
    unit: Annotated[str, Meta(pattern=_UNIT)] = ""
    scale: float = 1.0
    offset: float = 0.0
    rate_hz: Annotated[float, Meta(gt=0.0, le=10.0)] = 1.0
    timeout_s: Positive = 10.0  # silent for longer is told, and no longer sent
    invalid: tuple[float, ...] = ()  # what the source says where it has not measured: 85000 of a DS18B20
    i2c_bus: I2cBus = 1  # of parts.i2c_bus unless given
    address: Annotated[int, Meta(ge=0x48, le=0x4B)] = 0x48
    channel: Annotated[int, Meta(ge=0, le=3)] = 0
    port: str = ""
    baud: Annotated[int, Meta(ge=1)] = 9600
    path: str = ""  # an asterisk stands for any text; the first that fits is read
    pattern: str = ""
    column: Annotated[int, Meta(ge=-1, le=100)] = -1
    min_value: float | None = None  # values beyond are no measurements
    max_value: float | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        try:
            groups = re.compile(self.pattern).groups
        except re.error as error:
            raise ValueError(f"pattern = {self.pattern!r}: {error}") from None
        if self.pattern and groups < 1:
            raise ValueError(f"pattern = {self.pattern!r}: expected a group in brackets around the number")
        if self.driver == "serial" and not self.port:
            raise ValueError(f"port of the probe {self.name}: expected a device, such as /dev/ttyUSB3")
        if self.driver == "file" and not self.path:
            raise ValueError(f"path of the probe {self.name}: expected a file")


def check_probes(probes: Sequence[ProbePart]) -> None:
    """Raises ValueError: two have one name, or one port and different baud rates."""
    names = [probe.name for probe in probes]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"probe: two are named {name!r}")
    bauds: dict[str, int] = {}
    for probe in probes:
        if probe.driver == "serial" and bauds.setdefault(probe.port, probe.baud) != probe.baud:
            raise ValueError(
                f"baud of the probe {probe.name}: another on {probe.port} has {bauds[probe.port]}"
            )
