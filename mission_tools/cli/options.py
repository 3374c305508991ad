"""The options that `mission-plan` and `mission-upload` share, by groups, and what they amount to."""

from argparse import BooleanOptionalAction, Namespace
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from companion.cli.parser import Parser, number, system_id
from companion.core.geo import LatLon
from mission_tools.assembly.plan_options import PlanOptions, Via, flags
from mission_tools.cli.arguments import position
from mission_tools.errors import UsageError
from mission_tools.vehicle.link_url import DEFAULT_LINK, DEFAULT_SYSTEM_ID, FORMS

if TYPE_CHECKING:
    from mission_tools.job.planned import Request


class _Options(Protocol):
    """A parser, or a group of its options."""

    def add_argument(self, *names: str, action: str, help: str) -> object:
        """As `argparse.ArgumentParser.add_argument`."""


def add_route(parser: Parser) -> None:
    """Where the route leads."""
    group = parser.add_argument_group("route")
    group.add_argument(
        "--start-at", metavar="LAT,LON", help="where it starts (also --start LAT,LON) [the boat]"
    )
    group.add_argument("--goal", metavar="LAT,LON", help="where it ends [the scenario's]")
    group.add_argument("--case", metavar="N", help="one of the scenario's cases")
    group.add_argument("--clearance", type=number, metavar="M", help="metres kept from everything")
    group.add_argument("--speed", type=number, metavar="M/S", help="speed over ground [the boat's]")
    group.add_argument("--cell", type=number, metavar="M", help="plan on a grid with cells of this side")
    group.add_argument("--heuristic", metavar="NAME", help="of the grid: octile, euclidean or manhattan")
    group.add_argument(
        "--as-route", action="store_true", help="SOURCE (.gpx .kml .geojson) is a route to sail, not a map"
    )
    group.add_argument(
        "--as-outline", action="store_true", help="the lines of SOURCE (.gpx) enclose water, they are no ways"
    )
    group.add_argument(
        "--check-on", metavar="MAP", help="of a finished mission: say what is odd in it there (none: no map)"
    )
    group.add_argument("--smooth", action=BooleanOptionalAction, help="pull the grid's path taut")


def add_tasks(parser: Parser) -> None:
    """More than a way from place to place."""
    group = parser.add_argument_group("tasks")
    group.add_argument(
        "--via",
        action="append",
        default=[],
        metavar="LAT,LON[@S]",
        help="a place on the way, perhaps with seconds to hold there; repeat it",
    )
    group.add_argument("--any-order", action="store_true", help="all places, the goal too, in the best order")
    group.add_argument("--return", action="store_true", help="back to the start at the end")
    group.add_argument("--hold", type=number, metavar="S", help="hold this long at every --via and the goal")
    group.add_argument(
        "--survey",
        metavar="FILE",
        help="passes along the shores and parallel tracks over the area in FILE (all: the whole water)",
    )
    group.add_argument(
        "--fill-gaps", metavar="FILE", help="a survey of what an earlier one left out: its gaps.geojson"
    )
    group.add_argument("--spacing", type=number, metavar="M", help="of a survey: between tracks")
    group.add_argument("--footprint", type=number, metavar="M", help="of a survey: width the sensor covers")
    group.add_argument(
        "--overlap", type=number, metavar="SHARE", help="of a survey: share of it that tracks cover twice"
    )
    group.add_argument(
        "--angle",
        type=_angle,
        metavar="DEG",
        help="of a survey: course of its tracks, or current: along --current [fewest turns]",
    )
    group.add_argument("--cross", type=number, metavar="M", help="of a survey: cross lines this far apart")
    group.add_argument(
        "--shore-passes",
        type=int,
        metavar="N",
        help="of a survey: so often along the shores [best of 6, 3, 0; 1 with --angle or --lead]",
    )
    group.add_argument(
        "--turn-radius",
        type=number,
        metavar="M",
        help="of a survey: of its turns [that of --boat, or on the spot]",
    )
    group.add_argument(
        "--lead", type=number, metavar="M", help="of a survey: straight on so far before and after each track"
    )
    group.add_argument(
        "--pattern", choices=("expanding-square", "spiral"), help="of a search: to sail instead of tracks"
    )
    group.add_argument("--at", metavar="LAT,LON", help="of --pattern: where it begins [the area's middle]")
    group.add_argument(
        "--trigger", metavar="camera:M", help="along tracks: an image every M metres, or relay:N on"
    )
    group.add_argument(
        "--follow-shore", metavar="LAT,LON", help="along the shore nearest to this place, all round"
    )
    group.add_argument("--distance", type=number, metavar="M", help="of --follow-shore: from the shore")
    group.add_argument(
        "--shore-to", choices=("port", "starboard"), help="of --follow-shore: its side [starboard]"
    )
    group.add_argument("--first", metavar="LAT,LON", help="of --follow-shore: only from here …")
    group.add_argument("--last", metavar="LAT,LON", help="… to here")


def add_areas(parser: Parser) -> None:
    """Fence and rally points."""
    group = parser.add_argument_group("fence and rally points")
    group.add_argument("--fence", metavar="FILE", help="plan inside this fence and upload it (none: clear)")
    group.add_argument("--rally", metavar="FILE", help="upload these rally points (none: clear)")
    group.add_argument(
        "--fence-from-map",
        action="store_true",
        help="a fence of the map's water for this route",
    )
    group.add_argument("--rally-from-map", action="store_true", help="rally points near the route")
    group.add_argument("--contract", action="store_true", help="both: fence and rally points from the map")


def add_costs(parser: Parser) -> None:
    """What the route costs the boat, and what makes it dear."""
    group = parser.add_argument_group("budget, currents and wind")
    group.add_argument(
        "--boat", metavar="BOAT.toml", help="time and charge out and home for this boat (also: lake, kit)"
    )
    group.add_argument(
        "--split", action="store_true", help="cut it into parts that each come home on one pack of --boat"
    )
    group.add_argument(
        "--resume",
        metavar="N[@ITEM]",
        help="of --split: part N alone, or its rest after ITEM was reached (mission-upload: [1])",
    )
    group.add_argument("--one-way", action="store_true", help="the boat need not come home")
    group.add_argument(
        "--beyond-range", action="store_true", help="plan it even if the charge does not suffice"
    )
    group.add_argument(
        "--current",
        metavar="M/S,DEG",
        help="speed and direction it flows to, or a .csv, .npz, .nc, .toml file",
    )
    group.add_argument(
        "--depart",
        metavar="TIME",
        help="2026-06-01T08:00Z, or seconds of the current's clock; A..B: the best departure between",
    )
    group.add_argument(
        "--wind", metavar="M_S@FROM", help="mean wind and where it comes from, such as 6@270; with --boat"
    )
    group.add_argument(
        "--least",
        choices=("time", "charge"),
        help="what the route costs least of in a current or wind [time]",
    )
    group.add_argument(
        "--open-water", type=number, metavar="M", help="keep off the shore where that is not too long"
    )
    group.add_argument(
        "--draught", type=number, metavar="M", help="keep out of water that the map says is less deep"
    )
    group.add_argument(
        "--air-draught", type=number, metavar="M", help="keep out from under bridges that are less high"
    )


def add_outputs(parser: Parser) -> None:
    """The options of the files that are written."""
    group = parser.add_argument_group("files")
    group.add_argument(
        "--save",
        "--out",
        type=Path,
        metavar="FILE",
        help="write it: .plan .waypoints .geojson .kml .gpx .html …",
    )
    group.add_argument(
        "--preview", type=Path, metavar="FILE", help="draw plan and track: .png .svg .pdf .html"
    )
    add_force(group)


def add_force(group: _Options) -> None:
    """Whether files of others may be replaced."""
    group.add_argument("--force", action="store_true", help="replace files that this program did not write")


def add_link(parser: Parser, default: str | None = DEFAULT_LINK) -> None:
    """The link to the vehicle. default: None where the program also works without."""
    group = parser.add_argument_group("vehicle")
    group.add_argument(
        "--connect",
        default=default,
        dest="link",
        metavar="URL",
        help=FORMS + (f" [{default}]" if default else ""),
    )
    group.add_argument(
        "--patience",
        type=number,
        dest="patience_s",
        default=10.0,
        metavar="S",
        help="wait for heartbeat, position, arming [10]",
    )
    group.add_argument(
        "--sign-key", type=Path, metavar="FILE", help="sign what is sent; take only what is signed"
    )
    group.add_argument(
        "--system-id",
        type=system_id,
        default=DEFAULT_SYSTEM_ID,
        metavar="N",
        help=f"our own id, 1 to 255 [{DEFAULT_SYSTEM_ID}]",
    )


def plan_options(given: Namespace) -> PlanOptions:
    """What the route options ask for. Raises UsageError: names the option and what was expected there."""
    chosen: dict[str, Any] = {"via": tuple(map(_via, given.via))}
    for field in fields(PlanOptions):
        flag = next(flags([field.name]))
        value = getattr(given, flag.removeprefix("--no-").lstrip("-").replace("-", "_"))
        if field.type == LatLon | None:
            value = position(flag, value)
        chosen.setdefault(field.name, value)
    if chosen["fill_gaps"] is not None:
        if chosen["survey"] is not None:
            raise UsageError("--survey and --fill-gaps are two surveys: plan one at a time")
        chosen["survey"] = chosen["fill_gaps"]
    return PlanOptions(**chosen)


def request(given: Namespace) -> "Request":
    """What a program is asked to do: the options are fields of Request by their names."""
    from mission_tools.job.planned import Request  # noqa: PLC0415 - numpy and more, not needed for --help

    names = vars(given).keys() & {field.name for field in fields(Request)}
    chosen = {name: getattr(given, name) for name in names}
    if given.contract:
        chosen |= {"fence_from_map": True, "rally_from_map": True}
    return Request(options=plan_options(given), **chosen)


def _angle(text: str) -> float | str:
    return text if text == "current" else number(text)


def _via(text: str) -> Via:
    """The place on the way that LAT,LON or LAT,LON@SECONDS names."""
    place, at, seconds = text.partition("@")
    found = position("--via", place)
    assert found is not None  # noqa: S101  a text was given
    try:
        return Via(found, float(seconds) if at else None)
    except ValueError:
        raise UsageError(f"--via '{text}': expected LAT,LON or LAT,LON@SECONDS") from None
