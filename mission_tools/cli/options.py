"""The options that `mission-plan` and `mission-upload` share, by groups, and what they amount to."""

from argparse import BooleanOptionalAction, Namespace, _ActionsContainer
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from companion.cli.parser import Parser, number, system_id
from companion.core.geo import LatLon
from mission_tools.assembly.plan_options import PlanOptions, Via, flags
from mission_tools.cli.arguments import position
from mission_tools.errors import UsageError
from mission_tools.vehicle.link_url import DEFAULT_LINK, DEFAULT_SYSTEM_ID, FORMS

if TYPE_CHECKING:
    from mission_tools.job.planned import Request


def mission_parser(program: str, description: str) -> Parser:
    """A parser of the options that plan a mission."""
    parser = Parser(program, description, "SOURCE")
    for add in (_add_route, _add_tasks, _add_areas, _add_costs, _add_outputs):
        add(parser)
    return parser


def _add_route(parser: Parser) -> None:
    """Where the route leads."""
    add = parser.add_argument_group("route").add_argument
    add("--start-at", metavar="LAT,LON", help="where it starts (also --start LAT,LON) [the boat]")
    add("--goal", metavar="LAT,LON", help="where it ends [the scenario's]")
    add("--case", metavar="N", help="one of the scenario's cases")
    add("--clearance", type=number, metavar="M", help="metres kept from everything")
    add("--speed", type=number, metavar="M/S", help="speed over ground [the boat's]")
    add("--cell", type=number, metavar="M", help="plan on a grid with cells of this side")
    add("--heuristic", metavar="NAME", help="of the grid: octile, euclidean or manhattan")
    add("--as-route", action="store_true", help="SOURCE (.gpx .kml .geojson) is a route to sail, not a map")
    add(
        "--as-outline", action="store_true", help="the lines of SOURCE (.gpx) enclose water, they are no ways"
    )
    add("--check-on", metavar="MAP", help="of a finished mission: say what is odd in it there (none: no map)")
    add("--smooth", action=BooleanOptionalAction, help="pull the grid's path taut")


def _add_tasks(parser: Parser) -> None:
    """More than a way from place to place."""
    add = parser.add_argument_group("tasks").add_argument
    add(
        "--via",
        action="append",
        default=[],
        metavar="LAT,LON[@S]",
        help="a place on the way, perhaps with seconds to hold there; repeat it",
    )
    add("--any-order", action="store_true", help="all places, the goal too, in the best order")
    add("--return", action="store_true", help="back to the start at the end")
    add("--hold", type=number, metavar="S", help="hold this long at every --via and the goal")
    add(
        "--survey",
        metavar="FILE",
        help="passes along the shores and parallel tracks over the area in FILE (all: the whole water)",
    )
    add("--fill-gaps", metavar="FILE", help="a survey of what an earlier one left out: its gaps.geojson")
    add("--spacing", type=number, metavar="M", help="of a survey: between tracks")
    add("--footprint", type=number, metavar="M", help="of a survey: width the sensor covers")
    add("--overlap", type=number, metavar="SHARE", help="of a survey: share of it that tracks cover twice")
    add(
        "--angle",
        type=_angle,
        metavar="DEG",
        help="of a survey: course of its tracks, or current: along --current [fewest turns]",
    )
    add("--cross", type=number, metavar="M", help="of a survey: cross lines this far apart")
    add(
        "--shore-passes",
        type=int,
        metavar="N",
        help="of a survey: so often along the shores [best of 6, 3, 0; 1 with --angle or --lead]",
    )
    add(
        "--turn-radius",
        type=number,
        metavar="M",
        help="of a survey: of its turns [that of --boat, or on the spot]",
    )
    add(
        "--lead", type=number, metavar="M", help="of a survey: straight on so far before and after each track"
    )
    add("--pattern", choices=("expanding-square", "spiral"), help="of a search: to sail instead of tracks")
    add("--at", metavar="LAT,LON", help="of --pattern: where it begins [the area's middle]")
    add("--trigger", metavar="camera:M", help="along tracks: an image every M metres, or relay:N on")
    add("--follow-shore", metavar="LAT,LON", help="along the shore nearest to this place, all round")
    add("--distance", type=number, metavar="M", help="of --follow-shore: from the shore")
    add("--shore-to", choices=("port", "starboard"), help="of --follow-shore: its side [starboard]")
    add("--first", metavar="LAT,LON", help="of --follow-shore: only from here …")
    add("--last", metavar="LAT,LON", help="… to here")


def _add_areas(parser: Parser) -> None:
    """Fence and rally points."""
    add = parser.add_argument_group("fence and rally points").add_argument
    add("--fence", metavar="FILE", help="plan inside this fence and upload it (none: clear)")
    add("--rally", metavar="FILE", help="upload these rally points (none: clear)")
    add("--fence-from-map", action="store_true", help="a fence of the map's water for this route")
    add("--rally-from-map", action="store_true", help="rally points near the route")
    add("--contract", action="store_true", help="both: fence and rally points from the map")


def _add_costs(parser: Parser) -> None:
    """What the route costs the boat, and what makes it dear."""
    add = parser.add_argument_group("budget, currents and wind").add_argument
    add("--boat", metavar="BOAT.toml", help="time and charge out and home for this boat (also: lake, kit)")
    add("--split", action="store_true", help="cut it into parts that each come home on one pack of --boat")
    add(
        "--resume",
        metavar="N[@ITEM]",
        help="of --split: part N alone, or its rest after ITEM was reached (mission-upload: [1])",
    )
    add("--one-way", action="store_true", help="the boat need not come home")
    add("--beyond-range", action="store_true", help="plan it even if the charge does not suffice")
    add(
        "--current",
        metavar="M/S,DEG",
        help="speed and direction it flows to, or a .csv, .npz, .nc, .toml file",
    )
    add(
        "--depart",
        metavar="TIME",
        help="2026-06-01T08:00Z, or seconds of the current's clock; A..B: the best departure between",
    )
    add("--wind", metavar="M_S@FROM", help="mean wind and where it comes from, such as 6@270; with --boat")
    add(
        "--least",
        choices=("time", "charge"),
        help="what the route costs least of in a current or wind [time]",
    )
    add("--open-water", type=number, metavar="M", help="keep off the shore where that is not too long")
    add("--draught", type=number, metavar="M", help="keep out of water that the map says is less deep")
    add("--air-draught", type=number, metavar="M", help="keep out from under bridges that are less high")


def _add_outputs(parser: Parser) -> None:
    """The options of the files that are written."""
    group = parser.add_argument_group("files")
    add = group.add_argument
    written = "write it: .plan .waypoints .geojson .kml .gpx .html …"
    add("--save", "--out", type=Path, metavar="FILE", help=written)
    add("--preview", type=Path, metavar="FILE", help="draw plan and track: .png .svg .pdf .html")
    add_force(group)


def add_force(group: _ActionsContainer) -> None:
    """Whether files of others may be replaced."""
    group.add_argument("--force", action="store_true", help="replace files that this program did not write")


def add_link(parser: Parser, default: str | None = DEFAULT_LINK) -> None:
    """The link to the vehicle. default: None where the program also works without."""
    add = parser.add_argument_group("vehicle").add_argument
    add(
        "--connect",
        default=default,
        dest="link",
        metavar="URL",
        help=FORMS + (f" [{default}]" if default else ""),
    )
    add(
        "--patience",
        type=number,
        dest="patience_s",
        default=10.0,
        metavar="S",
        help="wait for heartbeat, position, arming [10]",
    )
    add("--sign-key", type=Path, metavar="FILE", help="sign what is sent; take only what is signed")
    add(
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
