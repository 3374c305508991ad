"""Names of figures and settings as people read them, with their units, for pages and pictures."""

import re

_LABELS = {
    "completed": "mission completed",
    "sim_seconds": "simulated (s)",
    "cpu_seconds": "computing time (s)",
    "real_time_factor": "times real time",
    "planned_length_m": "planned length (m)",
    "path_length_m": "sailed length (m)",
    "time_s": "time under way (s)",
    "cross_track_rms_m": "cross-track error, RMS (m)",
    "cross_track_max_m": "cross-track error, largest (m)",
    "path_rms_m": "off the path, RMS (m)",
    "path_max_m": "off the path, largest (m)",
    "kept_rms_m": "off the legs, RMS (m)",
    "kept_max_m": "off the legs, largest (m)",
    "start_max_m": "off the first leg, largest (m)",
    "overshoot_m": "overshoot at corners (m)",
    "cut_m": "passes waypoints by at most (m)",
    "min_clearance_m": "nearest to shore or obstacle (m)",
    "station_near_share": "share of time near the station",
    "station_95_m": "off the station, 95 % of time (m)",
    "command_travel_per_s": "command travel (full scales per s)",
    "motor_travel_per_min": "motor travel (full scales a minute)",
    "astern_caused_s": "astern at speed, with a cause (s)",
    "astern_false_s": "astern at speed, without a cause (s)",
    "current_m_s": "current (m/s)",
    "gust_m_s": "gusts (m/s)",
    "state_hash": "hash of the final state",
    "is_settled": "settled at the end",
}
_UNITS = (
    ("_per_s", "per s"),
    ("_rad_s", "rad/s"),
    ("_m_s", "m/s"),
    ("_m2", "m²"),
    ("_mah", "mAh"),
    ("_deg", "°"),
    ("_rad", "rad"),
    ("_kg", "kg"),
    ("_hz", "Hz"),
    ("_m", "m"),
    ("_s", "s"),
    ("_n", "N"),
    ("_v", "V"),
    ("_a", "A"),
    ("_w", "W"),
    ("_c", "°C"),
)
_KEY = re.compile(r"\b[a-z][a-z0-9]*(?:[._][a-z0-9]+)+\b")
_FILES = ("toml", "geojson", "json", "plan", "waypoints")


def label(key: str) -> str:
    """A figure's or a setting's name: “environment.current_m_s” becomes “environment: current (m/s)”."""
    *folder, name = key.split(".")
    text = _LABELS.get(name)
    if text is None:
        suffix, unit = next(((end, unit) for end, unit in _UNITS if name.endswith(end)), ("", ""))
        text = name.removesuffix(suffix).replace("_", " ") + (f" ({unit})" if unit else "")
    return f"{' '.join(folder).replace('_', ' ')}: {text}" if folder else text


def labelled(text: str) -> str:
    """Text with every key in it by its label; names of files stay."""
    return _KEY.sub(lambda m: m[0] if m[0].rpartition(".")[2] in _FILES else label(m[0]), text)
