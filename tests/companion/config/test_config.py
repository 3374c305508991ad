import tomllib
from pathlib import Path

import pytest

from companion.config.boat_config import BoatConfig, decode_config, load_config, with_value
from companion.core.errors import ConfigError


def decoded(text: str) -> BoatConfig:
    return decode_config(tomllib.loads(text), "boat.toml")


def test_a_file_names_only_what_differs() -> None:
    config = decoded("links = ['udpin::14550']\n[heading]\nkp = 4\n")
    assert config.heading.kp == 4.0
    assert isinstance(config.heading.kp, float)
    assert config.heading.ki == BoatConfig().heading.ki
    assert config.links == ("udpin::14550",)


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("[heading]\nkpp = 1.0", "kpp"),
        ("[haeding]\nkp = 1.0", "haeding"),
        ("[heading]\nkp = -1.0", "heading.kp"),
        ("[heading]\nkp = inf", "kp"),
        ("[heading]\nkp = 1e39", "kp"),
        ("[heading]\nmax_steering = 1.5", "heading.max_steering"),
        ("[identity]\nsystem_id = 256", "identity.system_id"),
        ("[failsafe]\ngcs_enabled = 1", "failsafe.gcs_enabled"),
        ("[failsafe]\naction = 7", "failsafe.action"),
        ("[parts.motors]\ndriver = 'warp'", "parts.motors.driver"),
        ("links = [5760]", "links"),
    ],
)
def test_a_key_that_cannot_be_used_is_named(text: str, key: str) -> None:
    with pytest.raises(ConfigError, match=key) as caught:
        decoded(text)
    assert "boat.toml" in str(caught.value)
    assert caught.value.exit_code == 2


def test_a_file_that_is_missing_or_no_toml_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"missing\.toml"):
        load_config(tmp_path / "missing.toml")
    path = tmp_path / "bad.toml"
    path.write_text("[heading]\nkp = = 1\n", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"bad\.toml.*line 2"):
        load_config(path)
    path.write_bytes(b"title = '\xff'\n")
    with pytest.raises(ConfigError, match=r"bad\.toml"):
        load_config(path)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("heading.kpp", 1.0),
        ("nothing.kp", 1.0),
        ("kp", 1.0),
        ("links", ()),
        ("", 1.0),
        ("heading.kp", -0.1),
        ("heading.kp", float("inf")),
        ("failsafe.action", 1.5),
        ("failsafe.gcs_enabled", 1.0),
    ],
)
def test_a_value_that_does_not_fit_is_refused_by_its_path(path: str, value: object) -> None:
    with pytest.raises(ConfigError) as caught:
        with_value(BoatConfig(), path, value)
    assert str(caught.value).startswith(f"{path}:")
