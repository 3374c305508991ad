"""What the vehicle holds against what was sent, item by item and field by field."""

import math
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from mission_tools.mission.mission import MissionItem, command_name, plain_frame


@dataclass(frozen=True, slots=True)
class Difference:
    """A field of an item that did not come back as it went. `item` is the sequence number, home being 0."""

    item: int
    field: str
    sent: object
    held: object

    def __str__(self) -> str:
        return f"item {self.item}: {self.field} sent {self.sent}, held {self.held}"


def differences(
    sent: Sequence[MissionItem], held: Sequence[MissionItem], *, home_is_the_vehicles: bool
) -> list[Difference]:
    """Every difference between two wire lists.

    Whole numbers must be equal; floating-point ones may differ by one unit in the last place of the wire's
    float32, and NaN equals NaN. home_is_the_vehicles: item 0 is the vehicle's own business, as on ArduPilot.
    """
    found = []
    if len(sent) != len(held):
        found.append(Difference(min(len(sent), len(held)), "number of items", len(sent), len(held)))
    for number, (ours, theirs) in enumerate(zip(sent, held, strict=False)):
        if number > 0 or not home_is_the_vehicles:
            found += _item_differences(number, ours, theirs)
    return found


def _item_differences(number: int, sent: MissionItem, held: MissionItem) -> Iterator[Difference]:
    if sent.command != held.command:
        yield Difference(number, "command", command_name(sent.command), command_name(held.command))
    if plain_frame(sent.frame) != plain_frame(held.frame):
        yield Difference(number, "frame", int(sent.frame), int(held.frame))
    for field in ("x", "y", "autocontinue"):
        if getattr(sent, field) != getattr(held, field):
            yield Difference(number, field, getattr(sent, field), getattr(held, field))
    pairs = [*zip(sent.params, held.params, strict=True), (sent.z, held.z)]
    for field, (ours, theirs) in zip(("param1", "param2", "param3", "param4", "z"), pairs, strict=True):
        if not same_float32(ours, theirs):
            yield Difference(number, field, ours, theirs)


def same_float32(a: float, b: float) -> bool:
    """Whether two numbers are at most one unit in the last place apart once both are float32."""
    if math.isnan(a) or math.isnan(b):
        return math.isnan(a) and math.isnan(b)
    return abs(_ordered_bits(a) - _ordered_bits(b)) <= 1


def _ordered_bits(value: float) -> int:
    """A float32's bits as an integer that counts up with the value; both zeros are 0."""
    try:
        bits: int = struct.unpack("<i", struct.pack("<f", value))[0]
    except OverflowError:  # beyond float32: its infinity
        bits = 0x7F800000 if value > 0 else 0x7F800000 - 2**31
    return bits if bits >= 0 else -(bits + 2**31)
