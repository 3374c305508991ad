"""Wheels that come from outside."""

import shutil
import struct
import zipfile
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from wheels import make_wheel, record_line

from companion.core import wheel_file
from companion.core.errors import ConfigError
from companion.core.requirement import satisfies, unmet_requirement
from companion.core.wheel_file import WheelInfo, inspect_wheel

INFO = "mavboat-0.2.0.dist-info"


def refused(path: Path) -> str:
    """Why a wheel is refused: one line that begins with the file's name."""
    with pytest.raises(ConfigError) as caught:
        inspect_wheel(path)
    text = str(caught.value)
    assert text.startswith(f"{path.name[:120]}: ")
    assert "\n" not in text
    return text


def test_a_right_wheel_has_its_version_and_its_file_name(tmp_path: Path) -> None:
    wheel = make_wheel(tmp_path, requires="Requires-Dist: msgspec>=0.18\nRequires-Dist: x; extra == 'web'")
    assert inspect_wheel(wheel) == WheelInfo("0.2.0", "mavboat-0.2.0-py3-none-any.whl")


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("mavboat.whl", "not the name of a wheel"),
        ("mavboat-0.2.0-py3-none-any.zip", "not the name of a wheel"),
        ("other-0.2.0-py3-none-any.whl", "a wheel of other"),
        ("mavboat-0.2.0-cp311-cp311-linux_aarch64.whl", "one kind of machine"),
        ("mavboat-0.3.0-py3-none-any.whl", "0.3.0.dist-info only"),
        ("m" * 200 + "-1-py3-none-any.whl", "not the name of a wheel"),
    ],
)
def test_the_name_of_the_file_is_that_of_a_wheel_of_mavboat(tmp_path: Path, name: str, why: str) -> None:
    assert why in refused(make_wheel(tmp_path).rename(tmp_path / name))


@pytest.mark.parametrize(
    "name",
    ["/etc/passwd", "../x.py", "companion/../../x.py", "companion//x.py", "companion/./x",
     "companion/a\\b.py", "evil.pth", "companion", "mavboat-0.2.0.data/scripts/python", "companion/a\nb.py"],
)  # fmt: skip
def test_a_member_outside_mavboats_packages_is_refused(tmp_path: Path, name: str) -> None:
    assert "member" in refused(make_wheel(tmp_path, files={name: b"x"}))


def test_a_symbolic_link_and_a_second_member_of_a_name_are_refused(tmp_path: Path) -> None:
    wheel = make_wheel(tmp_path)
    link = zipfile.ZipInfo("companion/link.py")
    link.external_attr = 0o120777 << 16
    with zipfile.ZipFile(wheel, "a") as archive:
        archive.writestr(link, "/etc/passwd")
    assert "a link" in refused(wheel)
    wheel = make_wheel(tmp_path)
    with zipfile.ZipFile(wheel, "a") as archive, pytest.warns(UserWarning, match="Duplicate"):
        archive.writestr("companion/__init__.py", "evil()")
    assert "there twice" in refused(wheel)


def test_the_content_is_what_record_says(tmp_path: Path) -> None:
    rows = "".join(
        record_line(name, content)
        for name, content in (("companion/__init__.py", b"other"), (f"{INFO}/WHEEL", b""))
    )
    assert "not in RECORD" in refused(make_wheel(tmp_path, record=rows + f"{INFO}/RECORD,,\n"))
    right = make_wheel(tmp_path)
    with zipfile.ZipFile(right) as archive:
        text = archive.read(f"{INFO}/RECORD").decode()
    wrong = text.replace("companion/__init__.py,sha256=", "companion/__init__.py,sha256=AAAA", 1)
    assert "not what RECORD says" in refused(make_wheel(tmp_path, record=wrong))
    assert "not what RECORD says" in refused(make_wheel(tmp_path, record=text.replace("sha256", "md5")))
    assert "not in the wheel" in refused(make_wheel(tmp_path, record=text + "companion/gone.py,,\n"))
    assert "a line twice" in refused(make_wheel(tmp_path, record=text + text))


@pytest.mark.parametrize("name", ["METADATA", "WHEEL"])
def test_a_wheel_without_its_descriptions_is_refused(tmp_path: Path, name: str) -> None:
    assert f"no {INFO}/{name}" in refused(make_wheel(tmp_path, files={f"{INFO}/{name}": None}))


def test_a_wheel_without_record_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "mavboat-0.2.0-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("companion/__init__.py", "")
    assert f"no {INFO}/RECORD" in refused(path)


def test_another_distribution_or_version_inside_is_refused(tmp_path: Path) -> None:
    other = b"Metadata-Version: 2.4\nName: other\nVersion: 0.2.0\n"
    assert "other 0.2.0" in refused(make_wheel(tmp_path, files={f"{INFO}/METADATA": other}))
    old = b"Metadata-Version: 2.4\nName: mavboat\nVersion: 0.1.0\n"
    assert "mavboat 0.1.0" in refused(make_wheel(tmp_path, files={f"{INFO}/METADATA": old}))


def test_what_the_wheel_needs_has_to_be_installed(tmp_path: Path) -> None:
    absent = make_wheel(tmp_path, requires="Requires-Dist: not-there-at-all>=2")
    assert "needs not-there-at-all >=2, which is not installed" in refused(absent)
    assert "needs msgspec >=99" in refused(make_wheel(tmp_path, requires="Requires-Dist: msgspec>=99"))
    python = b"Metadata-Version: 2.4\nName: mavboat\nVersion: 0.2.0\nRequires-Python: >=4\n"
    assert "needs Python >=4" in refused(make_wheel(tmp_path, files={f"{INFO}/METADATA": python}))


@pytest.mark.parametrize("name", ["python", "../../bin/sh", "boat-x/../../y", "pip"])
def test_a_program_that_would_replace_another_is_refused(tmp_path: Path, name: str) -> None:
    text = f"[console_scripts]\n{name} = companion.x:main\n".encode()
    assert "entry point" in refused(make_wheel(tmp_path, files={f"{INFO}/entry_points.txt": text}))


def test_a_bomb_is_counted_while_it_is_read(tmp_path: Path) -> None:
    bomb = make_wheel(tmp_path, files={"companion/zeros.bin": bytes(wheel_file.MOST_UNPACKED_BYTES)})
    assert bomb.stat().st_size < 1_000_000
    assert "unpacks to more than" in refused(bomb)
    text = make_wheel(tmp_path, files={f"{INFO}/METADATA": bytes(2_000_000)})
    assert "more than 1000000 bytes" in refused(text)


def test_a_size_that_the_directory_understates_is_refused(tmp_path: Path) -> None:
    wheel = make_wheel(tmp_path, files={"companion/zeros.bin": bytes(50_000)})
    content = wheel.read_bytes()
    wheel.write_bytes(content.replace(struct.pack("<L", 50_000), struct.pack("<L", 10)))
    assert refused(wheel)


def test_too_many_files_and_too_large_a_file_are_refused(tmp_path: Path) -> None:
    many = {f"companion/{n}.py": b"" for n in range(wheel_file.MOST_FILES)}
    assert "expected at most 3000" in refused(make_wheel(tmp_path, files=many))
    more = {f"companion/{n}{'x' * 60}.py": b"" for n in range(12_000)}
    assert "too many files" in refused(make_wheel(tmp_path, files=more))
    large = make_wheel(tmp_path)
    with large.open("ab") as file:
        file.truncate(wheel_file.MOST_PACKED_BYTES + 1)
    assert "expected at most 30000000" in refused(large)


def test_what_is_no_zip_and_what_is_not_there_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "mavboat-0.2.0-py3-none-any.whl"
    assert "cannot be read" in refused(path)
    for content in (b"", b"PK\x05\x06", b"x" * 1000):
        path.write_bytes(content)
        assert "not a plain zip file" in refused(path)


@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(data=st.data())
def test_a_damaged_wheel_is_a_sentence_or_unharmed(tmp_path: Path, data: st.DataObject) -> None:
    wheel = make_wheel(tmp_path)
    content = bytearray(wheel.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    wheel.write_bytes(content)
    try:
        assert inspect_wheel(wheel).version == "0.2.0"
    except ConfigError as error:
        assert str(error).startswith(wheel.name)  # noqa: PT017


@pytest.mark.parametrize(
    ("version", "clauses", "is_satisfied"),
    [
        ("1.2", ">=1.2.0", True), ("1.10", ">=1.9", True), ("1.2rc1", ">=1.2", False),
        ("1.2.post1", ">1.2", True),
        ("1.2", "<2,>=1", True), ("2.0", "<2", False), ("1.2.5", "~=1.2.3", True), ("1.3", "~=1.2.3", False),
        ("1.2.5", "==1.2.*", True), ("1.3", "!=1.2.*", True), ("1.3", "==1.3.0", True),
        ("3.13.5", ">=3.11", True),
        ("3.13.5", ">=4", False), ("1", "", True),
    ],
)  # fmt: skip
def test_versions_compare_by_their_numbers(version: str, clauses: str, *, is_satisfied: bool) -> None:
    assert satisfies(version, clauses) is is_satisfied


@pytest.mark.parametrize(
    "text", ["x @ https://e.x/y.whl", "x>=1; python_version < '3'", ">=3", "x => 2", "x>=abc"]
)
def test_a_requirement_that_is_not_understood_is_refused_not_guessed(text: str) -> None:
    with pytest.raises(ConfigError):
        unmet_requirement(text, lambda _: "1.0")


def test_a_requirement_of_an_extra_does_not_count() -> None:
    text = "lgpio>=0.2.2; (python_version < '3.13') and extra == 'pi'"
    assert unmet_requirement(text, lambda _: None) is None
    assert unmet_requirement("lgpio", lambda _: None) == "needs lgpio, which is not installed"


def test_the_copy_under_another_name_is_refused(tmp_path: Path) -> None:
    copy = tmp_path / "new.whl"
    shutil.copy(make_wheel(tmp_path), copy)
    assert "not the name of a wheel" in refused(copy)
