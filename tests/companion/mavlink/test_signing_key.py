import hashlib
import logging
import pickle
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.errors import ConfigError
from companion.mavlink.signing_key import SigningKey, parse_key, read_key_file

SECRET = bytes(range(32))


def key_file(folder: Path, content: bytes, mode: int = 0o600) -> Path:
    path = folder / "boat.key"
    path.write_bytes(content)
    path.chmod(mode)
    return path


@pytest.mark.parametrize("end", ["", "\n", "\r\n"])
def test_a_file_holds_bytes_digits_or_a_passphrase(tmp_path: Path, end: str) -> None:
    raw = bytes(range(200, 232))
    assert read_key_file(key_file(tmp_path, raw)).reveal() == raw
    assert read_key_file(key_file(tmp_path, (SECRET.hex().upper() + end).encode())).reveal() == SECRET
    phrase = f"many a mickle makes a muckle{end}"
    expected = hashlib.sha256(b"many a mickle makes a muckle").digest()
    assert read_key_file(key_file(tmp_path, phrase.encode())).reveal() == expected


def test_a_passphrase_of_32_characters_is_a_passphrase() -> None:
    for line in (b"p" * 32, b"p" * 31 + b"\n"):
        assert parse_key(line) == SigningKey.from_passphrase(line.decode().strip())


@given(st.binary(min_size=31, max_size=31))
def test_any_32_bytes_that_are_no_line_of_text_are_the_key(raw: bytes) -> None:
    assert parse_key(raw + b"\xff").reveal() == raw + b"\xff"


@given(st.binary(max_size=5000))
def test_any_content_is_a_key_or_a_value_error(content: bytes) -> None:
    try:
        key = parse_key(content)
    except ValueError as error:
        assert "\n" not in str(error)  # noqa: PT017
    else:
        assert len(key.reveal()) == 32


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"", "the file is empty"),
        (b"\n", "the file is empty"),
        (b"\xff" * 31, "these 31 bytes"),
        (b"two\nlines\n", "these 10 bytes"),
        (b"ab" * 31, "62 hexadecimal digits"),
        (b"x" * 5000, "more than 4096 bytes"),
        (b"00" * 32, "not all of them zero"),
    ],
)
def test_what_is_no_key_is_told_with_file_and_form(tmp_path: Path, content: bytes, told: str) -> None:
    path = key_file(tmp_path, content)
    with pytest.raises(ConfigError, match=told) as caught:
        read_key_file(path)
    assert str(caught.value).startswith(f"{path}: ")


@pytest.mark.parametrize("mode", [0o640, 0o604])
def test_a_file_that_others_can_get_at_is_refused_with_the_cure(tmp_path: Path, mode: int) -> None:
    path = key_file(tmp_path, SECRET, mode)
    with pytest.raises(ConfigError, match=f"mode {mode:04o}.*chmod 600 {path}"):
        read_key_file(path)


def test_a_key_appears_in_no_log_or_representation(caplog: pytest.LogCaptureFixture) -> None:
    key = SigningKey(SECRET)
    with caplog.at_level(logging.DEBUG):
        logging.getLogger("test").debug("%s %r", key, [key])
    for said in (repr(key), str(key), f"{key}", caplog.text):
        assert SECRET.hex() not in said
        assert repr(SECRET) not in said
        assert "hidden" in said
    with pytest.raises(TypeError):
        pickle.dumps(key)
