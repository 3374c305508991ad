"""An emulated encounter: the boat gives way to crossing traffic."""

from typing import Final

from pictures.svg import Drawing
from sitl.experiments.encounters.encounter import Encounter, encounter_trials, sail_encounter
from sitl.world.movers import Movers
from sitl.world.truth import Truth

SEED: Final = 5
_BEFORE_S, _AFTER_S = 6, 6  # the closest approach
_NUMBERED: Final = 5  # s
_WIDTH, _HEIGHT, _EDGE = 640.0, 480.0, 60.0
_BOAT, _TRAFFIC = "#1f4fa3", "#c83c32"


def draw_encounter() -> str:
    """Both tracks, north up, a dot each second; every few seconds a number, and the traffic in its size."""
    (trial,) = encounter_trials([Encounter("crossing", speed_m_s=0.5)], [SEED], {})
    run = sail_encounter(trial)
    movers = Movers(run.scenario.movers)
    truths = [Truth._make(row) for row in run.recorder.rows.tolist()]
    closest = min(truths, key=lambda at: movers.gap_m(at.east_m, at.north_m, at.time_s))
    first_s, last_s = closest.time_s - _BEFORE_S, closest.time_s + _AFTER_S
    boat = [(at.time_s, at.east_m, at.north_m) for at in truths if first_s <= at.time_s <= last_s]
    traffic = [(time_s, *movers.positions_m(time_s)[0]) for time_s, _, _ in boat]

    easts_m, norths_m = zip(*((one[1], one[2]) for one in (*boat, *traffic)), strict=True)
    scale = min(
        (_WIDTH - 2.0 * _EDGE) / (max(easts_m) - min(easts_m)),
        (_HEIGHT - 2.0 * _EDGE) / (max(norths_m) - min(norths_m)),
    )

    def pixel(east_m: float, north_m: float) -> tuple[float, float]:
        return _EDGE + scale * (east_m - min(easts_m)), _HEIGHT - _EDGE - scale * (north_m - min(norths_m))

    drawing = Drawing()
    drawing.line(*(pixel(east, north) for _, east, north, _ in traffic), colour=_TRAFFIC)
    drawing.line(*(pixel(east, north) for _, east, north in boat), colour=_BOAT, width=3.0)
    each_second = len(boat) // (_BEFORE_S + _AFTER_S)
    for second, (at, other) in enumerate(zip(boat[::each_second], traffic[::each_second], strict=True)):
        _, east, north, radius_m = other
        x, y = pixel(east, north)
        is_numbered = second % _NUMBERED == 0
        drawing.dot(x, y, _TRAFFIC, 3.0)
        if is_numbered:  # rings of every second would lie over each other and their numbers
            drawing.ring(x, y, scale * radius_m, "none", _TRAFFIC)
            drawing.write(x, y - scale * radius_m - 9.0, str(second), "middle", 11.0)
        x, y = pixel(at[1], at[2])
        drawing.dot(x, y, _BOAT, 4.0)
        if is_numbered:
            drawing.write(x + 10.0, y, str(second), size=11.0)
    words = "blue: the boat, going north; red: crossing traffic; a dot each second, rings in its size"
    drawing.write(20.0, 20.0, words)
    drawing.scale_bar(20.0, _HEIGHT - 20.0, scale)
    return drawing.text(_WIDTH, _HEIGHT, "Giving way to crossing traffic")
