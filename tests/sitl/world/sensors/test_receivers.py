"""Classes of receivers: their figures follow published ones, and one key chooses a class."""

import math
import statistics
from pathlib import Path

import pytest

from companion.core.errors import ConfigError
from companion.core.geo import LatLon, LocalFrame
from sitl.scenarios.scenario import BOATS, load_scenario
from sitl.world.sensors.gnss import SimGnss, stated_accuracy_m
from sitl.world.sensors.receivers import OF_CLASS, RECEIVERS, GnssSettings

FRAME = LocalFrame(LatLon(50.0, -1.2))
CLASS = "sensors.gnss.receiver"


def errors(settings: GnssSettings, fixes: int, seed: int = 1) -> tuple[list[complex], list[complex]]:
    """Of the positions and the velocities of a boat at rest."""
    gnss = SimGnss(settings, FRAME, seed)
    positions, velocities = [], []
    for count in range(fixes):
        gnss.sample(count / settings.rate_hz + 10.0, 0.0, 0.0, 0.0, 0.0)
        fix = gnss.read()
        if fix is not None:
            positions.append(complex(*FRAME.to_local(fix.position)))
            velocities.append(complex(fix.north_m_s or 0.0, fix.east_m_s or 0.0))
    return positions, velocities


def quick(receiver: str, rate_hz: float) -> GnssSettings:
    """Of a class, without delay."""
    figures = {key: getattr(RECEIVERS[receiver], key) for key in OF_CLASS}
    return GnssSettings(receiver=receiver, rate_hz=rate_hz, latency_s=0.0, jitter_s=0.0, **figures)  # type: ignore[arg-type]


def likeness(values: list[complex], steps: int) -> float:
    """Autocorrelation of a process of mean 0."""
    pairs = zip(values, values[steps:], strict=False)
    there = math.fsum((a.conjugate() * b).real for a, b in pairs) / (len(values) - steps)
    return there / statistics.fmean(abs(one) ** 2 for one in values)


@pytest.mark.parametrize(
    ("receiver", "cep_m"), [("standalone", (1.5, 2.5)), ("sbas", (0.4, 1.0)), ("rtk", (0.01, 0.3))]
)
def test_half_of_a_days_positions_lie_within_the_radius_of_the_data_sheets(
    receiver: str, cep_m: tuple[float, float]
) -> None:
    positions, _ = errors(quick(receiver, 0.05), 8_000)  # two days
    least_m, most_m = cep_m
    assert least_m <= statistics.median(abs(one) for one in positions) <= most_m


@pytest.mark.parametrize("receiver", RECEIVERS)
def test_half_of_the_speeds_are_right_to_the_five_centimetres_a_second_of_the_data_sheets(
    receiver: str,
) -> None:
    _, velocities = errors(quick(receiver, 5.0), 6_000)
    assert statistics.median(abs(one.real) for one in velocities) == pytest.approx(0.05, abs=0.008)


def test_a_standalone_receivers_positions_wander_for_minutes_and_its_velocities_for_a_second() -> None:
    positions, _ = errors(quick("standalone", 0.1), 20_000)
    share = 0.6**2 / (0.6**2 + 1.2**2 + 0.1**2), 1.2**2 / (0.6**2 + 1.2**2 + 0.1**2)
    for steps, for_s in ((6, 60.0), (40, 400.0)):
        expected = share[0] * math.exp(-for_s / 60.0) + share[1] * math.exp(-for_s / 400.0)
        assert likeness(positions, steps) == pytest.approx(expected, abs=0.06)
    _, velocities = errors(quick("standalone", 5.0), 8_000)
    assert 0.8 <= likeness(velocities, 1) <= 0.9  # Borre and Tiberius 2000, at 5 Hz
    assert likeness(velocities, 5) == pytest.approx(math.exp(-1.0), abs=0.04)
    assert abs(likeness(errors(quick("rtk", 5.0), 8_000)[1], 1)) < 0.02


def test_the_wander_begins_in_its_steady_state() -> None:
    first = [errors(quick("standalone", 5.0), 2, seed)[0][0] for seed in range(400)]
    square = statistics.fmean(abs(one) ** 2 for one in first)
    assert square == pytest.approx(2.0 * (1.2**2 + 0.6**2), rel=0.15)


def test_a_better_class_states_a_better_accuracy_and_geometry() -> None:
    ranks = [RECEIVERS[name] for name in ("standalone", "sbas", "rtk")]
    assert [one.fix_type for one in ranks] == [3, 4, 5]
    assert [stated_accuracy_m(one.fix_type, one.hdop) for one in ranks] == pytest.approx([1.1, 0.6, 0.3])
    assert [one.satellites for one in ranks] == sorted(one.satellites for one in ranks)


def test_one_key_chooses_the_class_over_the_boats_own_figures_and_single_keys_over_the_class() -> None:
    settings = load_scenario("pool", [f"{CLASS}=rtk", "sensors.gnss.noise_m=0.02"]).sensors.gnss
    assert (settings.noise_m, settings.wander_m, settings.rate_hz) == (0.02, RECEIVERS["rtk"].wander_m, 10.0)
    assert load_scenario("pool").sensors.gnss.noise_m == 0.004
    for name, one in RECEIVERS.items():
        chosen = load_scenario("open", [f"{CLASS}={name}"]).sensors.gnss
        assert {key: getattr(chosen, key) for key in ("receiver", *OF_CLASS)} == {
            key: getattr(one, key) for key in ("receiver", *OF_CLASS)
        }


def test_a_scenarios_class_lies_over_the_boats_and_under_its_own_keys(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(
        '[origin]\nlat_deg = 50.0\nlon_deg = -1.2\n[sensors.gnss]\nreceiver = "sbas"\nslow_m = 2.0\n',
        encoding="utf-8",
    )
    settings = load_scenario(str(file)).sensors.gnss
    assert (settings.receiver, settings.slow_m) == ("sbas", 2.0)
    assert settings.wander_m == RECEIVERS["sbas"].wander_m


@pytest.mark.parametrize("boat", sorted(path.stem for path in BOATS.glob("*.toml")))
def test_every_boat_on_the_water_has_the_kits_standalone_receiver(boat: str) -> None:
    settings = load_scenario("open", [f"boat.model={boat}"]).sensors.gnss
    assert settings.receiver == ("rtk" if boat == "pool" else "standalone")


def test_an_unknown_class_is_named_with_its_key() -> None:
    with pytest.raises(ConfigError, match=r"--set: sensors\.gnss\.receiver: .*galileo"):
        load_scenario("open", [f"{CLASS}=galileo"])
