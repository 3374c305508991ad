"""Numbers that nobody means, and files that nest without end: one line that names the file or key, at once.

Each would otherwise be an "unexpected" error, a start that hangs, or gigabytes of memory.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.boat import TICK_S
from companion.config.boat_config import BoatConfig, load_config
from companion.core.errors import BoatError, ConfigError
from mission_tools.errors import MapError, MissionToolsError
from mission_tools.maps.scenario import load_scenario as load_map
from sitl.cli.program import run_program
from sitl.experiments.campaign.campaign import MOST_RUNS, load_campaign
from sitl.experiments.result_log import NAME, ResultLog
from sitl.scenarios.scenario import Tree, load_scenario
from sitl.world.world import World

DIGITS = "9" * 5000
DEEP = [
    "a = " + "[" * 100_000,
    "a" + ".a" * 50 + " = 1",
]
READERS: list[tuple[Callable[[Path], object], type[Exception]]] = [
    (load_config, ConfigError),
    (load_campaign, ConfigError),
    (lambda path: load_scenario(str(path)), ConfigError),
    (load_map, MapError),
]


@pytest.mark.parametrize(("reader", "error"), READERS)
@pytest.mark.parametrize("text", [f"a = {DIGITS}", *DEEP], ids=["digits", *"12"])
def test_a_toml_file_that_cannot_be_meant_is_one_line_with_its_name(
    reader: Callable[[Path], object], error: type[Exception], text: str, tmp_path: Path
) -> None:
    path = tmp_path / "strange.toml"
    path.write_text(text)
    with pytest.raises(error, match=r"strange\.toml") as caught:
        reader(path)
    assert len(str(caught.value)) < 400
    assert "set_int_max_str_digits" not in str(caught.value)


@pytest.mark.parametrize("seeds", [10**22, MOST_RUNS + 1])
def test_a_campaign_of_too_many_seeds_is_refused_before_they_are_laid_out(tmp_path: Path, seeds: int) -> None:
    path = tmp_path / "many.toml"
    path.write_text(f"[run]\nseeds = {seeds}\n")
    with pytest.raises(ConfigError, match=r"many\.toml: run\.seeds"):
        load_campaign(path)


def test_a_campaign_of_too_many_combinations_is_refused_before_they_are_laid_out(tmp_path: Path) -> None:
    path = tmp_path / "many.toml"
    values = list(range(100))
    path.write_text(
        "[grid]\n" + "".join(f"a{n} = {values}\n" for n in range(12)) + "[run]\nseeds = 1000000\n"
    )
    with pytest.raises(ConfigError, match=rf"{100**12 * 10**6} runs are more than {MOST_RUNS}"):
        load_campaign(path)


@pytest.mark.parametrize(
    "arguments",
    [
        ["encounters", "--first-seed", "1" + "0" * 22],
        ["sail", "open", "--seed", "1" + "0" * 22],
        ["sail", "open", "--set", f"seed={DIGITS}"],
        ["sail", "open", "--set", "a" + ".a" * 5000 + "=1"],
        ["serve", "open", "--count", "2147483648"],
    ],
    ids=lambda arguments: " ".join(arguments)[:30],
)
def test_an_argument_that_cannot_be_meant_is_wrong_usage(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_program(arguments) == 2
    said = capsys.readouterr().err
    assert "unexpected" not in said
    assert said.count("\n") == 1


@pytest.mark.parametrize("setting", ["environment.current_m_s=1e22", "environment.wind_m_s=1e38"])
def test_water_in_which_no_boat_stays_on_the_map_ends_the_run_with_a_line(
    setting: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_program(["sail", "open", "--course", "straight", "--set", setting]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "left the map after" in said
    assert "out of all proportion" in said


@pytest.mark.parametrize("kind", ["garbage", "drift"])
def test_a_receivers_errors_stay_on_the_globe(kind: str) -> None:
    for key in ("noise_m", "wander_m", "multipath_m"):
        with pytest.raises(ConfigError, match=rf"sensors\.gnss\.{key}"):
            load_scenario("open", [f"sensors.gnss.{key}=1e38"])
    settings = [f'faults=[{{what="gnss", kind="{kind}", at_s=0.5, size=1e38}}]']
    world = World(load_scenario("open", [*settings, "sensors.gnss.noise_m=1e5"]))
    for _ in range(200):
        world.step(TICK_S)


@pytest.mark.parametrize("line", [b"[" * 100_000, b"\xff"])
def test_a_damaged_line_of_a_campaigns_runs_is_named(tmp_path: Path, line: bytes) -> None:
    (tmp_path / "c.toml").write_text('[run]\ncourse = "straight"\n')
    plan = load_campaign(tmp_path / "c.toml")
    ResultLog(tmp_path, plan).close()
    with (tmp_path / NAME).open("ab") as file:
        file.write(line + b"\n")
    with pytest.raises(ConfigError, match=rf"{NAME}: line 2 is damaged: remove it"):
        ResultLog(tmp_path, plan)


def numbers_of(type_: Any, prefix: str = "") -> list[str]:  # noqa: ANN401
    """The paths of all settings that are numbers."""
    found = []
    for field in msgspec.structs.fields(type_):
        if isinstance(field.type, type) and issubclass(field.type, msgspec.Struct):
            found += numbers_of(field.type, f"{prefix}{field.name}.")
        elif "float" in str(field.type) or "int" in str(field.type):
            found.append(prefix + field.name)
    return found


SETTINGS = [*numbers_of(Tree), *numbers_of(BoatConfig, "vehicle.")]
EXTREMES = ["1e308", "-1e308", "1e38", "-1e38", "1e-308", str(10**22), str(2**63), str(2**31)]


@given(st.sampled_from(SETTINGS), st.sampled_from([*EXTREMES, "0", "-1", "nan", "inf"]))
def test_no_number_anywhere_is_more_than_a_line(key: str, number: str) -> None:
    said = ""
    try:
        load_scenario("open", [f"{key}={number}"])
    except (BoatError, MissionToolsError) as error:
        said = str(error)
    assert not said or any(part in said for part in key.split("."))
