"""Lists to upload to a boat, and whether what was read back is what was sent."""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem, MissionType
from mission_tools.station.items import Kind
from mission_tools.station.requests import BoatCommand
from mission_tools.station.words import say

WAY_S: Final = 6.0  # leaves time for the start within the ten seconds of a request
PLAN_S: Final = 20.0
PLAN_PER_ITEM_S: Final = 1.5  # upload and reading back, where a fifth of the frames is lost both ways
LONGEST_S: Final = 280.0  # the page waits for 300 s
_FIRST: Final = 1.0  # the item after home
_SAIL: Final = BoatCommand(dialect.MAV_CMD_MISSION_START, (_FIRST,), say("answer.sail"), once=True)
_START: Final = BoatCommand(dialect.MAV_CMD_MISSION_START, (_FIRST,), say("answer.plan"), once=True)
_SINGLE: Final = 1e-5  # of a parameter: a boat may keep it with less precision than single
_PLAIN: Final = {5: 0, 6: 3, 11: 10}  # MAV_FRAME_…_INT means the same in MISSION_ITEM_INT


class ListUpload(NamedTuple):
    kind: Kind
    number: MissionType
    items: Sequence[MissionItem]


class Upload(NamedTuple):
    """Lists in the order of their upload, and what follows.

    start: a command once the boat has them, or None. is_read_back: first see what it has, as of a plan.
    retries: until a boat that does not answer is given up, every half second.
    """

    parts: tuple[ListUpload, ...]
    start: BoatCommand | None
    limit_s: float
    is_read_back: bool = False
    retries: int = 4


def way_upload(way: Sequence[tuple[int, int]]) -> Upload:
    """A way to sail at once. Home (which the boat replaces by its own) and a waypoint for each point."""
    frame = dialect.MAV_FRAME_GLOBAL_RELATIVE_ALT
    items = [
        MissionItem(frame=frame, command=dialect.MAV_CMD_NAV_WAYPOINT, x=x, y=y) for x, y in (way[0], *way)
    ]
    return Upload((ListUpload("mission", MissionType.MISSION, items),), _SAIL, WAY_S)


def plan_upload(
    mission: Sequence[MissionItem],
    fence: Sequence[MissionItem] = (),
    rally: Sequence[MissionItem] = (),
    *,
    is_started: bool,
) -> Upload:
    """A plan as it is; its fence first, as the boat checks a mission against it."""
    lists = (
        ListUpload("fence", MissionType.FENCE, fence),
        ListUpload("rally", MissionType.RALLY, rally),
        ListUpload("mission", MissionType.MISSION, mission),
    )
    parts = tuple(part for part in lists if part.items)
    count = sum(len(part.items) for part in parts)
    limit_s = min(PLAN_S + PLAN_PER_ITEM_S * count, LONGEST_S)
    return Upload(parts, _START if is_started else None, limit_s, is_read_back=True, retries=20)


def first_difference(part: ListUpload, held: Sequence[MissionItem]) -> int | None:
    """The number of the first item that the boat holds differently; None if it has all. Home is its own."""
    first = 1 if part.kind == "mission" else 0
    for seq, (ours, theirs) in enumerate(zip(part.items, held, strict=False)):
        if seq >= first and not _is_same(ours, theirs):
            return seq
    return None if len(part.items) == len(held) else min(len(part.items), len(held))


def _is_same(sent: MissionItem, held: MissionItem) -> bool:
    """NaN leaves a parameter to the boat."""
    pairs = (
        (sent.param1, held.param1), (sent.param2, held.param2), (sent.param3, held.param3),
        (sent.param4, held.param4), (sent.z, held.z),
    )  # fmt: skip
    return (
        (sent.command, sent.x, sent.y) == (held.command, held.x, held.y)
        and _PLAIN.get(sent.frame, sent.frame) == _PLAIN.get(held.frame, held.frame)
        and all(math.isnan(a) or math.isclose(a, b, rel_tol=_SINGLE, abs_tol=_SINGLE) for a, b in pairs)
    )
