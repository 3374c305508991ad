"""Kinds of rangers: how far each hears what, and where it meets the water."""

import math
import statistics

import pytest
import shapely
from msgspec.structs import replace

from companion.config.sensors import RANGES_M
from companion.core.geo import LatLon, LocalFrame
from mission_tools.maps.chart import Feature, build_chart
from sitl.scenarios.scenario import BOATS, load_scenario
from sitl.world.environment.settings import Environment
from sitl.world.environment.waves import Waves
from sitl.world.movers import Movers, MoverSettings
from sitl.world.sensors.rangers import OF_KIND, RANGERS, SonarSettings
from sitl.world.sensors.sonar import SimSonar
from sitl.world.shore import Shore

FRAME = LocalFrame(LatLon(50.0, -1.2))
SEA = Shore(build_chart("sea", FRAME, None, ()), reach_m=12.0)
KIND = "sensors.sonar.ranger"
PARTS = [ranger for ranger in RANGERS if ranger != "ideal"]


def of_kind(ranger: str, **values: float) -> SonarSettings:
    """Fixed ahead, without wild readings."""
    kind = replace(RANGERS[ranger], sweep_deg=0.0, ghost_share=0.0, noise_m=0.0)
    return replace(kind, **values)


def bank(north_m: float) -> Shore:
    """A straight wall ahead."""
    water = shapely.box(-50.0, -50.0, 50.0, north_m)
    return Shore(build_chart("bank", FRAME, water, ()), reach_m=12.0)


def share(
    settings: SonarSettings,
    shore: Shore = SEA,
    post: tuple[float, float, float] | None = None,
    pings: int = 400,
) -> float:
    """Share of the pings with an echo. post: east, north and radius."""
    movers = Movers([MoverSettings(start=post[:2], radius_m=post[2])]) if post else None
    sonar, heard = SimSonar(settings, shore, 1, movers), []
    for ping in range(pings):
        sonar.sample(ping * settings.ping_s, 0.0, 0.0, 0.0)
        heard += [one.range_m is not None for one in sonar.read()]
    return statistics.fmean(heard)


def test_a_mover_is_heard_once_its_echo_is_the_nearest() -> None:
    """A mover that comes out from behind a wall; the boat may hear the wall all the time."""
    movers = Movers([MoverSettings(start=(0.0, 4.0), at_s=1.0, velocity_m_s=(0.0, -1.0))])
    sonar = SimSonar(of_kind("ideal"), bank(2.95), 1, movers)
    for tenth in range(30):
        sonar.sample(0.1 * tenth, 0.0, 0.0, 0.0)
    assert sonar.mover_heard_s == pytest.approx(1.6)  # its edge is 0.5 m nearer
    assert SimSonar(of_kind("ideal"), bank(2.95), 1).mover_heard_s == math.inf


@pytest.mark.parametrize("ranger", PARTS)
def test_a_kind_states_the_range_that_its_driver_states(ranger: str) -> None:
    settings = load_scenario("open", [f"{KIND}={ranger}"]).sensors.sonar
    assert (settings.min_range_m, settings.max_range_m) == RANGES_M[ranger]
    assert all(getattr(settings, key) == getattr(RANGERS[ranger], key) for key in OF_KIND)
    sonar = SimSonar(settings, SEA, 1)
    sonar.sample(0.0, 0.0, 0.0, 0.0)
    (ping,) = sonar.read()
    assert (ping.range_m, ping.max_range_m) == (None, RANGES_M[ranger][1])


@pytest.mark.parametrize("boat", sorted(path.stem for path in BOATS.glob("*.toml")))
def test_every_boat_has_the_kits_ranger_and_single_keys_change_it(boat: str) -> None:
    settings = load_scenario("open", [f"boat.model={boat}", "sensors.sonar.cone_deg=20"]).sensors.sonar
    assert (settings.ranger, settings.cone_deg, settings.max_range_m) == ("hcsr04", 20.0, 4.0)


@pytest.mark.parametrize("ranger", PARTS)
def test_half_of_the_pings_return_from_a_wall_at_the_half_range_and_nearly_all_at_half_of_it(
    ranger: str,
) -> None:
    settings = of_kind(ranger)
    assert share(settings, bank(settings.half_range_m - 1e-6)) == pytest.approx(0.5, abs=0.1)
    assert share(settings, bank(0.5 * settings.half_range_m)) > 0.97


def test_the_smaller_a_body_the_less_far_it_is_heard() -> None:
    settings = of_kind("hcsr04")
    shares = [share(settings, post=(0.0, 3.0 + radius_m, radius_m)) for radius_m in (0.05, 0.2, 0.5, 2.0)]
    assert shares == sorted(shares)
    assert shares[0] < 0.1
    assert share(settings, bank(3.0)) > shares[-1] + 0.1
    # The loudness of a cylinder: 10 log(a / (a + r)) dB beside a wall's, here as deviations of the scatter
    excess_db = 20.0 * math.log10(4.0 / 2.0) + 2.6 * 2.0 + 10.0 * math.log10(0.5 / 2.5)
    expected = statistics.NormalDist().cdf(excess_db / 5.6)
    assert share(settings, post=(0.0, 2.5, 0.5), pings=4000) == pytest.approx(expected, abs=0.03)


def test_light_sees_a_thin_post_as_far_as_a_wall() -> None:
    settings = of_kind("tfmini")
    assert share(settings, post=(0.0, 5.05, 0.05)) == pytest.approx(share(settings, bank(5.0)), abs=0.05)


@pytest.mark.parametrize(("ranger", "is_heard"), [("hcsr04", False), ("jsnsr04t", True), ("a02yyuw", True)])
def test_the_wide_beams_hear_what_is_far_off_their_axis(ranger: str, is_heard: bool) -> None:
    off_rad, away_m, radius_m = math.radians(30.0), 1.5, 0.3
    post = (away_m * math.sin(off_rad), away_m * math.cos(off_rad), radius_m)
    assert (share(of_kind(ranger), post=post) > 0.5) is is_heard


def test_the_beams_edge_hears_a_quarter_of_the_loudness() -> None:
    range_m, radius_m = 2.0, 0.05
    small_db = 10.0 * math.log10((radius_m + range_m) / radius_m)
    away_m = range_m + radius_m
    off_rad = math.radians(7.5) + math.asin(radius_m / away_m)
    post = (away_m * math.sin(off_rad), away_m * math.cos(off_rad), radius_m)
    for margin_db, is_heard in ((5.9, False), (6.1, True)):
        half_range_m = range_m * 10.0 ** ((small_db + margin_db) / 20.0)
        settings = of_kind("hcsr04", half_range_m=half_range_m, scatter_db=0.0, loss_db_m=0.0)
        assert (share(settings, post=post, pings=3) > 0.5) is is_heard


def test_an_ideal_ranger_hears_the_smallest_post_in_its_cone_and_nothing_outside() -> None:
    for off_deg, expected in ((0.0, 1.0), (7.0, 1.0), (8.5, 0.0)):
        post = (3.8 * math.sin(math.radians(off_deg)), 3.8 * math.cos(math.radians(off_deg)), 0.05)
        assert share(of_kind("ideal"), post=post, pings=20) == expected


def test_what_is_within_the_blind_range_is_heard_at_its_end() -> None:
    sonar = SimSonar(of_kind("jsnsr04t"), bank(0.1), 1)
    sonar.sample(0.0, 0.0, 0.0, 0.0)
    assert [ping.range_m for ping in sonar.read()] == [0.25]


def test_a_rock_in_the_chart_is_as_round_as_its_outline_and_the_bank_is_flat() -> None:
    rock = Feature("rock", "obstacle", shapely.Point(0.0, 2.0).buffer(0.5, quad_segs=16))
    shore = Shore(build_chart("pond", FRAME, shapely.box(-5.0, -2.0, 5.0, 5.0), [rock]), reach_m=4.0)
    ((rock_m, rock_radius_m),) = shore.echoes(0.0, 0.0, [0.0], 4.0)
    assert rock_m == pytest.approx(1.5, abs=0.01)
    assert rock_radius_m == pytest.approx(0.5, rel=0.01)
    ((bank_m, bank_radius_m),) = shore.echoes(0.0, 0.0, [math.pi], 4.0)
    assert bank_m == pytest.approx(2.0)
    assert bank_radius_m == math.inf


def test_the_long_side_of_a_raft_is_flatter_than_its_short_one() -> None:
    raft = Feature("raft", "obstacle", shapely.box(-4.0, 2.0, 4.0, 3.0))
    shore = Shore(build_chart("pond", FRAME, shapely.box(-9.0, -9.0, 9.0, 9.0), [raft]), reach_m=4.0)
    ((_, side_m),) = shore.echoes(0.0, 0.0, [0.0], 4.0)
    ((_, end_m),) = shore.echoes(-6.0, 2.5, [0.5 * math.pi], 4.0)
    assert side_m == pytest.approx(8.0 / (0.5 * math.pi))
    assert end_m == pytest.approx(18.0 / math.tau)  # as round as the whole


def water(ranger: str, height_m: float, period_s: float, pitch_rad: float = 0.0) -> list[float]:
    """Ranges of echoes on open water in waves from ahead, a pitch added to theirs."""
    settings = of_kind(ranger)
    waves = Waves(Environment(wave_height_m=height_m, wave_period_s=period_s), 1.0, 5)
    sonar, heard = SimSonar(settings, SEA, 1), []
    for ping in range(2000):
        now_s = ping * settings.ping_s
        waves.step(now_s, 0.0, 0.0, 1.0, 0.0)
        waves.pitch_rad += pitch_rad
        sonar.sample(now_s, 0.0, 0.0, 0.0, waves)
        heard += [one.range_m for one in sonar.read() if one.range_m is not None]
    return heard


def test_calm_water_and_low_waves_give_no_echo_and_steep_ones_do() -> None:
    shares = [len(water("hcsr04", *sea)) / 2000 for sea in ((0.0, 1.8), (0.1, 3.0), (0.1, 1.8), (0.3, 1.8))]
    assert shares == sorted(shares)
    assert shares[0] == 0.0
    assert shares[2] < 0.005
    assert 0.01 < shares[3] < 0.1


def test_the_water_is_met_within_the_reach_of_a_level_beams_lower_edge() -> None:
    edge_m = 0.15 / math.tan(math.radians(7.5))  # of a level beam 1.14 m; steep faces are met earlier
    ranges_m = water("hcsr04", 0.3, 1.8)
    assert 0.5 * edge_m < statistics.median(ranges_m) < edge_m
    assert statistics.median(water("jsnsr04t", 0.3, 1.8)) < 0.5 * edge_m


def test_a_bow_that_dips_brings_more_echoes_and_light_goes_into_the_water() -> None:
    up, level, down = (len(water("hcsr04", 0.3, 1.8, math.radians(by))) for by in (6.0, 0.0, -6.0))
    assert up < level < down
    assert water("tfmini", 0.3, 1.8) == water("ideal", 0.3, 1.8) == []
