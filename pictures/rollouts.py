"""The rollouts before a rock, and an encounter that they decide. The boat moves as its own model does."""

import math
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.state import NavState
from companion.obstacles.perception.track import Track
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.cost import HORIZON_S, HULL, TOUCH, CostModel
from companion.obstacles.planning.cost_to_go import CostToGo
from companion.obstacles.planning.motion import CRASH_STOP, STEP_S, STEPS, Fan, Rollout, roll
from companion.obstacles.planning.movers import predict
from pictures.svg import Drawing

_CONFIG: Final = BoatConfig()
_SCALE: Final = 60.0  # pixels a metre
_GOOD, _BAD, _BEST = (46, 134, 71), (200, 60, 50), "#1f4fa3"


def draw_rollouts() -> str:
    """The fan of a boat at 1 m/s, bow up, with a rock ahead."""
    rock = [Point(3.0 + 0.2 * n, 0.3 + 0.2 * e) for n in range(4) for e in range(-3, 4)]
    nav, fan = _nav(0.0, 0.0, 0.0, 1.0), Fan()
    costs = _costs(nav, _field(nav, rock), [])
    best = costs.choose(fan, 1.0, None, None, is_certain=True)
    rated = []
    for speed in (1.0, 0.6, 0.4):
        for one in fan.rollouts(1.0, 0.0, speed, _CONFIG):
            rated.append((costs.plain(one, None) + costs.risk(one), one))
    least = min(cost for cost, _ in rated)
    drawing = Drawing()
    for cost, one in sorted(rated, key=lambda each: -each[0]):
        share = min((cost - least) / 3.0, 1.0)
        shade = "#" + "".join(f"{round(g + share * (b - g)):02x}" for g, b in zip(_GOOD, _BAD, strict=True))
        drawing.line(*_pixels(one), colour=shade, width=1.2)
    for at in rock:
        x, y = _pixel(at.north_m, at.east_m)
        drawing.box(x - 0.1 * _SCALE, y - 0.1 * _SCALE, 0.2 * _SCALE, 0.2 * _SCALE, "#777777")
    if best is not None:
        drawing.line(*_pixels(best), colour=_BEST, width=4.0)
    drawing.dot(*_pixel(0.0, 0.0), _BEST, 6.0)
    drawing.write(20.0, 20.0, "green: cheap, red: expensive, blue: the one that is held, grey: rock")
    return drawing.text(640.0, 480.0, "Rollouts before a rock")


def draw_encounter() -> str:
    """A boat on its way north, and a mover that crosses from port at 0.5 m/s."""
    heading, surge, north, east, held = 0.0, 1.0, 0.0, 0.0, None
    fan, boat, traffic = Fan(), [(0.0, 0.0)], []
    for step in range(40):
        now_s = 0.9 + step * STEP_S
        mover_n, mover_e = 3.6, -2.4 + 0.5 * step * STEP_S
        traffic.append((mover_n, mover_e))
        nav = _nav(north, east, heading, surge)
        track = _track(mover_n, mover_e, 0.0, 0.5, now_s)
        costs = _costs(nav, _field(nav, []), [track], now_s)
        aheads = [STEP_S * (step + 1) for step in range(STEPS)]
        path = aheads, [-east * ahead / HORIZON_S for ahead in aheads]
        best = costs.choose(fan, 1.0, path, held, is_certain=True)
        wanted = math.atan2(-east, 5.0) - heading
        one = best or roll(surge, 0.0, wanted, 1.0, _CONFIG)
        held = None if best is None else heading + best.turn_rad
        c, s = math.cos(heading), math.sin(heading)
        ahead, right = one.ahead_m[1] - one.ahead_m[0], one.right_m[1] - one.right_m[0]
        north, east = north + ahead * c - right * s, east + ahead * s + right * c
        heading += math.atan2(right, ahead) if ahead > 0.02 else 0.0
        surge = (
            math.hypot(ahead, right) / STEP_S * (-1.0 if one.speed_m_s == CRASH_STOP and ahead < 0.0 else 1.0)
        )
        boat.append((north, east))
    drawing = Drawing()
    for places, colour in ((boat, _BEST), (traffic, "#c83c32")):
        points = [_pixel(0.9 * n - 0.3, 1.2 * e) for n, e in places]
        drawing.line(*points, colour=colour, width=3.0)
        for number, (x, y) in enumerate(points[::4]):
            drawing.dot(x, y, colour, 5.0)
            drawing.write(x + 9.0, y, str(number), size=11.0)
    drawing.write(20.0, 20.0, "blue: the boat, red: crossing traffic, a dot each second")
    return drawing.text(640.0, 480.0, "Giving way to crossing traffic")


def _nav(north_m: float, east_m: float, heading_rad: float, surge_m_s: float) -> NavState:
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    return NavState(
        0.0, north_m, east_m, heading_rad, 0.0, surge_m_s * c, surge_m_s * s, surge_m_s, 0.0, 0.0, 0.0
    )


def _field(nav: NavState, rock: list[Point]) -> ClearanceField:
    field = ClearanceField(nav.point, 0.2, 9.0)
    field.fill(rock, rock, TOUCH)
    return field


def _costs(nav: NavState, field: ClearanceField, movers: list[Track], now_s: float = 0.0) -> CostModel:
    margin_m = _CONFIG.avoidance.margin_m
    to_go = CostToGo(field, nav.point, Point(50.0, 0.0), margin_m, HULL * margin_m)
    predicted = predict(movers, nav, (1.0, 0.0), field, margin_m, HULL * margin_m, now_s)
    return CostModel(nav, field, to_go, predicted, margin_m, HORIZON_S, 0.0, _CONFIG)


def _track(north_m: float, east_m: float, north_m_s: float, east_m_s: float, now_s: float) -> Track:
    """Observed for a second."""
    track = Track(1, now_s - 0.9, Point(north_m - 0.9 * north_m_s, east_m - 0.9 * east_m_s), 0.5)
    for look in range(1, 10):
        before_s = 0.1 * (9 - look)
        at = Point(north_m - before_s * north_m_s, east_m - before_s * east_m_s)
        track.predict(now_s - before_s, 0.0)
        track.correct(at, 1.0, 0.0, 0.05)
        track.correct(at, 0.0, 1.0, 0.05)
        track.complete_observation(0.5, 1.0, 0.0)
    track.is_mover = True
    return track


def _pixel(north_m: float, east_m: float) -> tuple[float, float]:
    return 320.0 + _SCALE * east_m, 420.0 - _SCALE * north_m


def _pixels(rollout: Rollout) -> list[tuple[float, float]]:
    places = zip((0.0, *rollout.ahead_m), (0.0, *rollout.right_m), strict=True)
    return [_pixel(ahead, right) for ahead, right in places]
