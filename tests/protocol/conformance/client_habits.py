"""How real clients wait, repeat and give up: one row a client, one figure a column.

Read off the public sources of QGroundControl 4.4, 5.0 and master, MAVSDK 4.1 and MAVProxy 1.8, or measured on
the running programs. Times are seconds; tries count the first one.
"""

import math
from dataclasses import dataclass, fields, replace

from patience import MOMENT_S
from vehicle_line import Who


@dataclass(frozen=True, slots=True)
class Habits:
    """One client.

    window: items asked for at a time. patience_s: the longest silence in an upload after its first request.
    repeats_item: whether it asks again for a lost item until item_tries are used up.
    """

    name: str
    address: Who
    list_wait_s: float = 1.5
    list_tries: int = 7
    item_wait_s: float = 0.25
    item_tries: int = 7
    window: int = 1
    acknowledges: bool = True
    count_wait_s: float = 1.5
    count_tries: int = 7
    patience_s: float = 1.5
    command_wait_s: float = 3.0
    command_tries: int = 1
    parameter_wait_s: float = 5.0
    parameter_tries: int = 5
    parameter_batch: int = 10
    file_wait_s: float = 1.0
    file_tries: int = 6


QGC_STATION = Who(255, 190)

QGC_44 = Habits("QGroundControl 4.4", QGC_STATION)
QGC_50 = Habits("QGroundControl 5.0", QGC_STATION)
QGC_MASTER = Habits("QGroundControl master", QGC_STATION, command_wait_s=1.2)
MAVSDK = Habits(
    "MAVSDK",
    Who(245, 190),
    list_wait_s=0.5,
    list_tries=6,
    item_wait_s=0.5,
    item_tries=6,
    count_wait_s=0.5,
    count_tries=6,
    patience_s=3.0,  # it waits through its tries without repeating the item
    command_wait_s=0.5,
    command_tries=4,
    parameter_wait_s=0.5,
    parameter_tries=4,
    file_wait_s=0.5,
    file_tries=11,
)
MAVPROXY = Habits(
    "MAVProxy",
    Who(255, 230),
    list_wait_s=10.0,
    list_tries=3,  # the person at the keyboard types it again
    item_wait_s=2.0,
    item_tries=100,  # really for as long as it runs
    window=5,
    acknowledges=False,
    count_wait_s=10.0,
    count_tries=3,
    patience_s=10.0,
    command_wait_s=3.0,
    parameter_wait_s=2.0,
    parameter_tries=20,
    parameter_batch=10,
    file_wait_s=1.0,
    file_tries=20,
)

CLIENTS = (QGC_50, MAVSDK, MAVPROXY)  # the others move lists as QGroundControl 5.0

# One that never gives up, to find out the truth after a client of the table has
PATIENT = Habits(
    "patient",
    Who(254, 190),
    list_tries=100,
    item_tries=100,
    count_tries=100,
    patience_s=60.0,
    command_tries=50,
)
assert all(math.isfinite(client.patience_s) for client in CLIENTS)


def in_no_hurry(habits: Habits) -> Habits:
    """The same client in real time beside other tests, where a wait that is over says nothing."""
    waits = [field.name for field in fields(habits) if field.name.endswith("_s")]
    return replace(habits, **dict.fromkeys(waits, MOMENT_S))  # type: ignore[arg-type]
