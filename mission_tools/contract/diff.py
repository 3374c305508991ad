"""What an upload would change aboard, in a few lines.

Items are aligned first, so that one inserted waypoint is one line and not a change of everything after it.
"""

from collections.abc import Iterator, Mapping, Sequence
from difflib import SequenceMatcher

from companion.core.geo import LatLon, geodesic_m
from mission_tools.mission.mission import (
    LIST_NAMES,
    MissionItem,
    MissionType,
    command_name,
    plain_frame,
)
from mission_tools.wording import counted, distance

SHOWN = 8  # lines a list

Lists = Mapping[MissionType, Sequence[MissionItem]]


def diff(new: Lists, held: Lists, *, is_ardupilot: bool) -> list[str]:
    """The changes from what is held to what is new, list by list; a list that stays has one line.

    is_ardupilot: item 0 of the mission is home and the vehicle's own.
    """
    lines: list[str] = []
    for kind, items in new.items():
        skipped = 1 if kind is MissionType.MISSION and is_ardupilot else 0
        changes = list(_changes(held[kind][skipped:], items[skipped:], skipped))
        name = LIST_NAMES[kind]
        if not changes:
            lines.append(f"{name}: the same as on board, {counted(len(items), 'item')}")
            continue
        if not items:
            lines.append(f"{name}: {counted(len(held[kind]), 'item')} on board, to be cleared")
            continue
        if not held[kind][skipped:]:
            lines.append(f"{name}: none on board, {counted(len(items), 'item')} to upload")
            continue
        lines.append(f"{name}: {counted(len(held[kind]), 'item')} on board, {len(items)} to upload")
        lines += [f"  {change}" for change in changes[:SHOWN]]
        if len(changes) > SHOWN:
            lines.append(f"  and {len(changes) - SHOWN} more changes")
    return lines


def _changes(held: Sequence[MissionItem], new: Sequence[MissionItem], first: int) -> Iterator[str]:
    aligned = SequenceMatcher(None, list(map(_key, held)), list(map(_key, new)), autojunk=False)
    for what, a, a_end, b, b_end in aligned.get_opcodes():
        if what == "equal":
            continue
        paired = min(a_end - a, b_end - b)
        for n in range(paired):
            yield f"item {b + n + first}: {_change(held[a + n], new[b + n])}"
        for n in range(a + paired, a_end):
            yield f"item {n + first} on board: {_said(held[n])} goes"
        for n in range(b + paired, b_end):
            yield f"item {n + first}: {_said(new[n])} is new"


def _key(item: MissionItem) -> tuple[object, ...]:
    """Equal for items that are the same to six digits, which the wire's float32 keeps; NaN equals NaN."""
    numbers = tuple(f"{value:.6g}" for value in (*item.params, item.z))
    return item.command, plain_frame(item.frame), item.x, item.y, numbers, item.autocontinue


def _change(held: MissionItem, new: MissionItem) -> str:
    if held.command != new.command:
        return f"{_said(held)} becomes {_said(new)}"
    changes = []
    if (held.x, held.y) != (new.x, new.y):
        here, there = _place(held), _place(new)
        if here is not None and there is not None:
            changes.append(f"moved by {distance(geodesic_m(here, there))} to {_at(there)}")
        else:
            changes.append(f"x, y {held.x}, {held.y} becomes {new.x}, {new.y}")
    pairs = zip((*held.params, held.z), (*new.params, new.z), strict=True)
    for name, (before, after) in zip(("param1", "param2", "param3", "param4", "z"), pairs, strict=True):
        if f"{before:.6g}" != f"{after:.6g}":
            changes.append(f"{name} {before:g} becomes {after:g}")
    if plain_frame(held.frame) != plain_frame(new.frame):
        changes.append(f"frame {int(held.frame)} becomes {int(new.frame)}")
    if held.autocontinue != new.autocontinue:
        changes.append("goes on by itself" if new.autocontinue else "waits for a command")
    return f"{command_name(new.command)} {', '.join(changes)}"


def _said(item: MissionItem) -> str:
    place = _place(item)
    return command_name(item.command) + (f" at {_at(place)}" if place is not None else "")


def _place(item: MissionItem) -> LatLon | None:
    return item.lat_lon if item.is_global else None


def _at(place: LatLon) -> str:
    return f"{place.lat_deg:.6f},{place.lon_deg:.6f}"
