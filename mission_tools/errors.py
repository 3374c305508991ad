"""What can go wrong in the planner, as one tree. Each error knows the exit code it ends a program with:

    MissionToolsError
    ├── MapError            2  a map or scenario that cannot be used; names file, feature and place
    ├── PlanFileError       2  a mission file that cannot be used; names file and item
    ├── LogError            2  a log that cannot be used; names the file
    ├── UsageError          2  arguments that do not go together
    ├── NoRouteError        1  the planner found no way
    │   ├── StartBlocked    2  the start is no place for a boat; names what is in the way
    │   ├── GoalBlocked     2  the goal is no place for a boat; names what is in the way
    │   └── NoRoute         1  start and goal are free, but no water joins them
    ├── BeyondRange         1  the charge does not take the boat there and home
    ├── VehicleError        1  the vehicle answered, but not as it should
    │   ├── UploadRejected  1  it refused the mission; says the reason and the item
    │   ├── ReadBackMismatch  1  what it holds is not what was sent; names the item
    │   └── CommandRefused  1  it refused to arm, to change mode or to start
    └── LinkError           3  no vehicle answers
        ├── NoVehicle       3  no heartbeat came
        └── LinkLost        3  the vehicle fell silent

The message is one line for a person: what was wrong, where, what was expected, what to do.
"""


# ruff: noqa: N818  (the leaves say what happened; their family's name says that it is an error)


class MissionToolsError(Exception):
    """Root of every error that the planner raises on purpose."""

    exit_code = 1


class MapError(MissionToolsError, ValueError):
    """A map or scenario that cannot be used."""

    exit_code = 2


class PlanFileError(MissionToolsError, ValueError):
    """A mission file that cannot be used."""

    exit_code = 2


class LogError(MissionToolsError, ValueError):
    """A log that cannot be used."""

    exit_code = 2


class UsageError(MissionToolsError, ValueError):
    """Arguments that do not go together."""

    exit_code = 2


class NoRouteError(MissionToolsError):
    """The planner found no way."""


class StartBlocked(NoRouteError):
    """The start is on land, outside the map, or no water a boat could leave from is near it."""

    exit_code = 2


class GoalBlocked(NoRouteError):
    """The goal is on land, outside the map, kept out of, or nearer to the shore than the clearance."""

    exit_code = 2


class NoRoute(NoRouteError):
    """Start and goal are free, but no water joins them."""


class BeyondRange(MissionToolsError):
    """The charge does not take the boat there and home."""


class VehicleError(MissionToolsError):
    """The vehicle answered, but not as it should."""


class UploadRejected(VehicleError):
    """The vehicle refused the mission."""


class ReadBackMismatch(VehicleError):
    """What the vehicle holds is not what was sent."""


class CommandRefused(VehicleError):
    """The vehicle refused to arm, to change mode or to start."""


class LinkError(MissionToolsError):
    """Nobody to talk to."""

    exit_code = 3


class NoVehicle(LinkError):
    """No heartbeat came within the patience."""


class LinkLost(LinkError):
    """The vehicle fell silent."""
