"""What `mission-plan` and `mission-upload` are asked for, and what they report."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from mission_tools.assembly.plan_options import PlanOptions
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.vehicle.link_url import DEFAULT_LINK, DEFAULT_SYSTEM_ID

if TYPE_CHECKING:
    from mission_tools.contract.budget import Budget
    from mission_tools.vehicle.mission_monitor import MissionMonitor


@dataclass(frozen=True, slots=True)
class Request:
    """What was asked for. source: None for fence and rally points alone, and the boat's mission stays."""

    source: str | None
    options: PlanOptions = field(default_factory=PlanOptions)
    link: str = DEFAULT_LINK
    system_id: int = DEFAULT_SYSTEM_ID
    patience_s: float = 10.0  # for the first heartbeat, the first position, and for arming
    start: bool = False
    follow: bool = False
    watch: bool = False  # and lead the mission round what the vehicle's rangers see
    timeout_s: float = math.inf
    dry_run: bool = False
    save: Path | None = None
    preview: Path | None = None
    force: bool = False  # replace files that other programs wrote
    sign_key: Path | None = None
    fence: str | None = None  # a file, or "none" to clear
    rally: str | None = None
    one_way: bool = False  # it need not come home
    beyond_range: bool = False  # plan it even if the charge does not suffice
    fence_from_map: bool = False
    rally_from_map: bool = False
    diff: bool = False  # say what an upload changes aboard
    if_changed: bool = False  # and send only the lists that it changes


@dataclass(slots=True)
class Report:
    """The results so far, also of a job that fails."""

    planned: PlannedMission | None = None
    area_notes: tuple[str, ...] = ()  # on the files of fence and rally points
    budget: "Budget | None" = None
    link: str = ""
    vehicle_id: int | None = None
    mode: str = ""
    items: int = 0
    lists: dict[str, int] = field(default_factory=dict)  # items of each list, cleared ones too
    changed: list[str] | None = None  # lists that differ from those on board; None: not compared
    upload_s: float = math.nan
    read_back_s: float = math.nan
    read_back_equal: bool = False
    started: bool = False
    monitor: "MissionMonitor | None" = None
    saved: Path | None = None
    preview: Path | None = None
