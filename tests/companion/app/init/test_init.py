"""`boat-companion init`: presets and answers become a whole, commented configuration."""

import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from companion.app.cli import run_program
from companion.app.init.presets import PRESETS, board_values, preset_text, with_values
from companion.app.init.questions import QUESTIONS, ask_all
from companion.config.board import read_model
from companion.config.boat_config import BoatConfig, decode_config, load_config

ROOT = Path(__file__).parents[4]
GUIDE = (ROOT / "docs" / "first-day.md").read_text(encoding="utf-8")
EXAMPLE = ROOT / "examples" / "configs" / "boat.toml"
presets = pytest.mark.parametrize("preset", PRESETS)


def config_of(text: str) -> BoatConfig:
    return decode_config(tomllib.loads(text), "text")


def leaves(tree: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from leaves(value, f"{path}{key}.")
        else:
            yield f"{path}{key}", value


def answers(**by_key: str) -> tuple[list[str], Any]:
    """What was asked, and a function that answers by key (dots as __) and takes the default otherwise."""
    asked: list[str] = []
    texts = {question.text: question.key for question in QUESTIONS}

    def ask(text: str, default: str) -> str:
        key = next(key for start, key in texts.items() if text.startswith(start))
        asked.append(key)
        return by_key.get(key.replace(".", "__"), default)

    return asked, ask


@presets
def test_every_preset_is_written_and_passes_the_check(
    preset: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "boat.toml"
    assert run_program(["init", "--preset", preset, "--yes", "--output", str(path)]) == 0
    assert run_program(["check", "--config", str(path)]) == 0
    assert capsys.readouterr().out.count("fine") == 1
    config = load_config(path)
    assert config.parts.motors.driver != "none"
    assert config.parts.compass.driver != "none"
    assert config.links
    assert config.storage.folder == "/var/lib/mavboat"
    assert path.read_text(encoding="utf-8").count("#") > 40


@presets
def test_a_presets_figures_are_those_of_the_emulators_boat(preset: str) -> None:
    """All but the compass error, which the emulator adds on purpose."""
    model = ROOT / "sitl" / "boats" / f"{PRESETS[preset].model}.toml"
    written = dict(leaves(tomllib.loads(preset_text(preset))))
    expected = dict(leaves(tomllib.loads(model.read_text(encoding="utf-8"))["vehicle"]))
    del expected["parts.compass.correction_rad"]
    assert {key: written.get(key) for key in expected} == expected


def test_the_example_is_the_lake_preset() -> None:
    """If not: boat-companion init --preset lake --yes --force --output examples/configs/boat.toml"""
    assert EXAMPLE.read_text(encoding="utf-8") == preset_text("lake")


def test_an_existing_file_is_kept_without_force(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "boat.toml"
    path.write_text("mine", encoding="utf-8")
    command = ["init", "--preset", "lake", "--yes", "--output", str(path)]
    assert run_program(command) == 2
    assert "exists" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == "mine"
    assert run_program([*command, "--force"]) == 0
    assert path.read_text(encoding="utf-8") == preset_text("lake")


def test_the_answers_are_in_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    replies = iter(["yacht", "lake", "10.0.0.255", "/dev/ttyUSB1"])
    asked, by_key = answers(identity__system_id="7", parts__gnss__driver="none")

    def prompt(text: str, default: str) -> str:
        is_of_a_key = any(text.startswith(question.text) for question in QUESTIONS)
        return str(by_key(text, default)) if is_of_a_key else next(replies)

    monkeypatch.setattr("companion.app.init.questions.ask", prompt)
    path = tmp_path / "boat.toml"
    assert run_program(["init", "--output", str(path)]) == 0
    config = load_config(path)
    assert [link.url for link in config.link_settings] == [
        "udpout:10.0.0.255:14550",
        "tcpin:127.0.0.1:5760",
        "serial:/dev/ttyUSB1:57600",
    ]
    assert (config.identity.system_id, config.parts.gnss.driver) == (7, "none")
    assert config.external.position == 2
    assert "parts.gnss.port" not in asked


def test_a_wrong_answer_is_explained_and_asked_again() -> None:
    replies = {"identity.system_id": ["300", "many", "8"], "parts.gnss.driver": ["loran", "ubx"]}
    texts = {question.text: question.key for question in QUESTIONS}
    complaints: list[str] = []

    def ask(text: str, default: str) -> str:
        key = next(key for start, key in texts.items() if text.startswith(start))
        return replies[key].pop(0) if replies.get(key) else default

    changed = ask_all(config_of(preset_text("lake")), ask, complaints.append)
    assert changed == {"identity.system_id": 8}
    assert [text.partition(":")[0] for text in complaints] == [
        "identity.system_id",
        "'many'",
        "parts.gnss.driver",
    ]


def test_a_driver_brings_the_values_that_it_needs_and_its_own_questions() -> None:
    asked, ask = answers(
        parts__gnss__driver="gpsd", parts__battery__driver="ina228", parts__sonar__driver="tfmini",
        parts__lidar__driver="ld06",
    )  # fmt: skip
    changed = ask_all(config_of(preset_text("lake")), ask, pytest.fail)
    assert changed == {
        "parts.gnss.driver": "gpsd",
        "parts.gnss.port": "localhost:2947",
        "parts.battery.driver": "ina228",
        "parts.battery.shunt_ohm": 0.002,
        "parts.sonar.driver": "tfmini",
        "parts.lidar.driver": "ld06",
    }
    assert {"parts.sonar.port", "parts.lidar.port"} <= set(asked)
    assert "parts.gnss.baud" not in asked


@pytest.mark.parametrize(
    ("model", "gnss_port", "rc_port"),
    [
        ("Raspberry Pi 5 Model B Rev 1.0", "/dev/ttyAMA0", "/dev/ttyAMA3"),
        ("Raspberry Pi 4 Model B Rev 1.4", "/dev/serial0", "/dev/ttyAMA4"),
        ("Raspberry Pi 3 Model B Plus Rev 1.3", "/dev/serial0", "/dev/ttyUSB0"),
        ("Raspberry Pi Zero 2 W Rev 1.0", "/dev/serial0", "/dev/ttyUSB0"),
        ("", "/dev/serial0", "/dev/ttyAMA4"),
    ],
)
def test_the_ports_are_those_of_the_model(model: str, gnss_port: str, rc_port: str, tmp_path: Path) -> None:
    path = tmp_path / "model"
    path.write_text(f"{model}\0", encoding="utf-8")
    assert read_model(path) == model
    config = config_of(preset_text("lake", board_values(model)))
    assert (config.parts.gnss.port, config.rc.port) == (gnss_port, rc_port)
    assert f"`{gnss_port}`" in GUIDE
    assert f"`{rc_port}`" in GUIDE or rc_port == "/dev/ttyUSB0"


TEXT = """[a]
x = 1    # one
name = "old"  # a name
[a.b]  # a table
x = 2
"""


def test_a_value_is_replaced_in_its_table_and_its_comment_stays_in_its_column() -> None:
    assert with_values(TEXT, {"a.x": 20}).splitlines()[1] == "x = 20   # one"
    assert with_values(TEXT, {"a.name": 'new "x"'}).splitlines()[2] == r'name = "new \"x\""  # a name'
    assert with_values(TEXT, {"a.b.x": True}).splitlines() == [*TEXT.splitlines()[:4], "x = true"]
