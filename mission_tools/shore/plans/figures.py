"""The figures of a plan, from the planner's report."""

from collections.abc import Mapping
from typing import Any


def line(report: Mapping[str, Any]) -> list[tuple[float, float]]:
    """Longitude and latitude of home, where it is known, and of each waypoint."""
    home = report["home"]
    places = [home, *report["waypoints"]] if home and any(home) else report["waypoints"]
    return [(round(lon, 7), round(lat, 7)) for lat, lon in places]


def time_s(report: Mapping[str, Any], route: Mapping[str, Any], speed_m_s: float | None) -> float | None:
    """By the budget, else at a speed; None where neither is known."""
    if report["budget"]:
        return float(report["budget"]["time_s"])
    if not speed_m_s:
        return None
    return float(route["length_m"] / speed_m_s + route.get("hold_s", 0.0))


def charge_percent(report: Mapping[str, Any]) -> float | None:
    """Of a full battery, out and home; None where the boat's file does not say what it draws."""
    budget = report["budget"]
    if not budget or budget["charge_mah"] is None or not budget["capacity_mah"]:
        return None
    home_mah = budget["home_mah"]
    return None if home_mah is None else 100.0 * (budget["charge_mah"] + home_mah) / budget["capacity_mah"]


def distance(length_m: float) -> str:
    """A distance for people: metres, or kilometres from 1 km."""
    return f"{length_m:.0f} m" if length_m < 10_000.0 else f"{length_m / 1000.0:.1f} km"
