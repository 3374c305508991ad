"""Fence and rally items: each by itself, and the list as a whole."""

import math

import pytest
from boat_rig import Rig

from companion.mavlink.items import MissionItem, MissionResult, MissionType
from companion.mavlink.transfer import Completed
from companion.services.missions.area_items import check_fence, check_fence_item, check_rally_item


def area(command: int, param1: float = 0.0, **fields: int) -> MissionItem:
    return MissionItem(
        command=command, param1=param1, **{"frame": 0, "x": 500_000_000, "y": -12_000_000, **fields}
    )


def polygon(vertices: int, command: int = 5001) -> list[MissionItem]:
    return [area(command, float(vertices), x=500_000_000 + n) for n in range(vertices)]


@pytest.mark.parametrize(
    "item",
    [area(5000), area(5001, 3.0), area(5002, 70.0, frame=3), area(5003, 12.5), area(5004, 0.1, frame=6)],
)
def test_what_a_fence_is_made_of_is_taken(item: MissionItem) -> None:
    assert check_fence_item(item) is None


@pytest.mark.parametrize(
    ("item", "result"),
    [
        (area(16), MissionResult.UNSUPPORTED),
        (area(5100), MissionResult.UNSUPPORTED),
        (area(5001, 2.0), MissionResult.INVALID_PARAM1),
        (area(5001, 3.5), MissionResult.INVALID_PARAM1),
        (area(5002, math.nan), MissionResult.INVALID_PARAM1),
        (area(5002, math.inf), MissionResult.INVALID_PARAM1),
        (area(5003, 0.0), MissionResult.INVALID_PARAM1),
        (area(5003, -1.0), MissionResult.INVALID_PARAM1),
        (area(5004, math.nan), MissionResult.INVALID_PARAM1),
        (area(5004, math.inf), MissionResult.INVALID_PARAM1),
        (area(5003, 5.0, frame=1), MissionResult.UNSUPPORTED_FRAME),
        (area(5000, x=0, y=0), MissionResult.INVALID_PARAM5_X),
        (area(5003, 100_001.0), MissionResult.INVALID_PARAM1),
        (area(5001, 3.0, x=850_000_001), MissionResult.INVALID_PARAM5_X),
        (area(5004, 1.0, x=-850_000_001), MissionResult.INVALID_PARAM5_X),
        (area(5000, x=900_000_001), MissionResult.INVALID_PARAM5_X),
        (area(5000, y=1_800_000_001), MissionResult.INVALID_PARAM6_Y),
    ],
)
def test_what_is_no_fence_is_refused_by_its_field(item: MissionItem, result: MissionResult) -> None:
    fault = check_fence_item(item)
    assert fault is not None
    assert fault.result is result


@pytest.mark.parametrize(
    ("item", "result"),
    [
        (area(5100), None),
        (area(5001, 3.0), MissionResult.UNSUPPORTED),
        (area(5100, frame=1), MissionResult.UNSUPPORTED_FRAME),
        (area(5100, x=0, y=0), MissionResult.INVALID_PARAM5_X),
    ],
)
def test_a_rally_point_is_a_place(item: MissionItem, result: MissionResult | None) -> None:
    fault = check_rally_item(item)
    assert (None if fault is None else fault.result) is result


@pytest.mark.parametrize(
    "items",
    [
        [],
        polygon(3),
        [*polygon(3), *polygon(3)],
        [*polygon(4), *polygon(3, 5002), area(5003, 5.0), area(5000)],
        [area(5004, 5.0), area(5004, 5.0)],
    ],
)
def test_whole_fences_hold_together(items: list[MissionItem]) -> None:
    assert check_fence(items) is None


@pytest.mark.parametrize(
    ("items", "word"),
    [
        (polygon(4)[:3], "breaks off after 3"),
        ([*polygon(4)[:2], *polygon(3)], "item 2"),
        ([*polygon(3)[:2], *polygon(3, 5002)], "item 2"),
        ([*polygon(3)[:1], area(5003, 5.0), *polygon(3)[1:]], "item 1"),
        ([area(5000), area(5000)], "item 1: a second return point"),
    ],
)
def test_broken_fences_are_refused_by_item(items: list[MissionItem], word: str) -> None:
    fault = check_fence(items)
    assert fault is not None
    assert word in fault.text


def test_what_the_disk_holds_is_checked_as_what_arrives() -> None:
    rig = Rig()
    rig.step()
    assert isinstance(rig.upload(polygon(3), mission_type=MissionType.FENCE), Completed)
    content = rig.storage.content["fence.json"]  # type: ignore[attr-defined]
    rig.storage.content["fence.json"] = content.replace(b'"param1": 3.0', b'"param1": 4.0')  # type: ignore[attr-defined]
    rig.reboot()
    assert rig.items(MissionType.FENCE) == ()


@pytest.mark.parametrize(("longitude", "is_refused"), [(-12_000_000, False), (0, False), (3_000_000, True)])
def test_a_polygon_that_spans_more_than_a_hundred_kilometres_is_refused_with_the_item(
    longitude: int, is_refused: bool
) -> None:
    """1.2° of longitude are 86 km at 50° north, 1.5° are 107 km."""
    fault = check_fence([*polygon(3)[:2], area(5001, 3.0, y=longitude)])
    assert (fault is not None) is is_refused
    if fault is not None:
        assert fault.result is MissionResult.INVALID_PARAM5_X
        assert fault.text == "item 2: 108 km from the first vertex; at most 100 km"
