"""Every client's transfers, on lines good and bad: they end, and leave the old list or the new, whole."""

import math

import pytest
from client_habits import CLIENTS, MAVSDK, QGC_50, Habits
from pymavlink.dialects.v20 import all as dialect
from station_client import Item, OpenClient, truth
from vehicle_line import PERFECT

from sitl.radio.channel import Quality

pytest_plugins = ("conformance_fixtures",)

MISSION, FENCE, RALLY = 0, 1, 2
LOSSES = (0.05, 0.2, 0.4)


def bad(loss: float) -> Quality:
    """A radio at the edge of its reach: late, doubled and out of order as well."""
    return Quality(loss, delay_s=0.03, jitter_s=0.04, duplication=0.05)


def items(mission_type: int, count: int, shift: int = 0) -> list[Item]:
    """A list of a type that every boat takes."""
    x, y = 500000000 + shift, -12000000
    if mission_type == MISSION:
        home = [Item(dialect.MAV_CMD_NAV_WAYPOINT, 0, x, y)]
        return home + [Item(16, 3, x + 500 * n, y + 500 * (n % 2), 50.0) for n in range(1, count)]
    if mission_type == RALLY:
        return [Item(dialect.MAV_CMD_NAV_RALLY_POINT, 3, x + 1000 * n, y) for n in range(count)]
    inclusion = dialect.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION
    ring = [n * math.tau / count for n in range(count)]
    return [
        Item(inclusion, 0, x + round(1e5 * math.cos(a)), y + round(1e5 * math.sin(a)), p1=float(count))
        for a in ring
    ]


CASES = [*((MISSION, loss) for loss in LOSSES), (FENCE, 0.2), (RALLY, 0.4)]


@pytest.mark.parametrize("habits", CLIENTS, ids=lambda habits: habits.name)
@pytest.mark.parametrize(("kind", "loss"), CASES)
def test_an_upload_ends_with_the_old_list_or_the_new_one_whole(
    client: OpenClient, habits: Habits, kind: int, loss: float
) -> None:
    station = client(habits, seed=kind + 7)
    old, new = items(kind, 5), items(kind, 20, shift=1_000_000)
    assert station.upload(old, kind) == dialect.MAV_MISSION_ACCEPTED
    station.line.quality = bad(loss)
    result = station.upload(new, kind)
    held = truth(station, kind)
    if result == dialect.MAV_MISSION_ACCEPTED:
        assert same(held, new, kind)
    else:
        assert same(held, old, kind) or same(held, new, kind)
    if loss <= 0.05:
        assert same(held, new, kind)
        assert result == dialect.MAV_MISSION_ACCEPTED


@pytest.mark.parametrize("habits", CLIENTS, ids=lambda habits: habits.name)
@pytest.mark.parametrize(("kind", "loss"), CASES)
def test_a_download_brings_the_whole_list_or_ends(
    client: OpenClient, habits: Habits, kind: int, loss: float
) -> None:
    station = client(habits, seed=kind + 11)
    new = items(kind, 15)
    assert station.upload(new, kind) == dialect.MAV_MISSION_ACCEPTED
    station.line.quality = bad(loss)
    held = station.download(kind)
    assert held is None or same(held, new, kind)
    assert held is not None or loss > 0.2
    assert same(truth(station, kind), new, kind)


@pytest.mark.parametrize("habits", [QGC_50, MAVSDK], ids=lambda habits: habits.name)  # MAVProxy never ends
def test_150_items_end_within_the_clients_own_retries_or_leave_the_old_plan_whole(
    client: OpenClient, habits: Habits
) -> None:
    loss = 0.4
    station = client(habits, seed=5)
    old, new = items(MISSION, 5), items(MISSION, 150, shift=1_000_000)
    assert station.upload(old) == dialect.MAV_MISSION_ACCEPTED
    station.line.quality = bad(loss)
    began_s = station.line.now_s
    result = station.upload(new)
    up_s = station.line.now_s - began_s
    held = truth(station)
    # A last word that is lost leaves the station without an answer and the boat with the new plan
    assert same(held, new, MISSION) or (result != dialect.MAV_MISSION_ACCEPTED and same(held, old, MISSION))
    station.line.quality = PERFECT
    assert station.upload(new) == dialect.MAV_MISSION_ACCEPTED
    station.line.quality = bad(loss)
    began_s = station.line.now_s
    read = station.download()
    down_s = station.line.now_s - began_s
    assert read is None or same(read, new, MISSION)
    assert same(truth(station), new, MISSION)
    ends = [
        "gave up" if result is None else dialect.enums["MAV_MISSION_RESULT"][result].name[12:].lower(),
        "gave up" if read is None else "whole",
    ]
    print(f"{habits.name}, {loss:.0%} loss: up {ends[0]} in {up_s:.1f} s, down {ends[1]} in {down_s:.1f} s")  # noqa: T201


def same(held: object, sent: object, kind: int) -> bool:
    """Whether two lists are the same; the vehicle answers for its own home, which is item 0 of a mission."""
    first = 1 if kind == MISSION else 0
    return (
        isinstance(held, list)
        and isinstance(sent, list)
        and len(held) == len(sent)
        and held[first:] == sent[first:]
    )
