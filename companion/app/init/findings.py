"""A part that `boat-companion init --detect` has found, and which of several is taken."""

from collections.abc import Callable, Iterable, Mapping
from typing import Final, NamedTuple

from companion.app.init.presets import Value

COMPASS: Final = "parts.compass.driver"
GNSS: Final = "parts.gnss.driver"
IMU: Final = "parts.compass.imu"


class Found(NamedTuple):
    """A part, and the values that configure it.

    key: of what it is to the boat, such as `parts.compass.driver`. doubt: why it may be something else.
    """

    key: str
    driver: str
    where: str
    values: Mapping[str, Value]
    doubt: str = ""

    def __str__(self) -> str:
        return f"{self.key} {self.driver}, {self.where}{self.doubt and f': not sure, {self.doubt}'}"


def choose(
    parts: Iterable[Found], accept: Callable[[Found], bool], say: Callable[[str], None]
) -> dict[str, Found]:
    """The parts to take, by key: of two for one key a sure one, and of those the first.

    Depth and heading of a receiver's line go with that receiver. accept: whether to take a part that is not
    sure. say: told what is left out.
    """
    taken: dict[str, Found] = {}
    for part in sorted(parts, key=lambda part: bool(part.doubt)):
        other = taken.get(part.key)
        if part.driver == "gnss" and taken.get(GNSS, part).where != part.where:
            other = taken[GNSS]
        if other is not None:
            say(f"left out: {part}; taken: {other}")
        elif part.doubt and not accept(part):
            say(f"left out: {part}")
        else:
            taken[part.key] = part
    return taken
