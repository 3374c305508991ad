"""The page's files: which are read, and what of them is sent."""

from pathlib import Path

import pytest
from shore_server import Server

from companion.core.errors import ConfigError
from mission_tools.shore.web.static_files import make_file, read_files

pytest_plugins = ("server_fixtures",)


def test_only_what_packs_well_is_packed() -> None:
    assert make_file("text/plain", b"short").packed is None
    assert make_file("text/plain", b"a" * 1000).packed is not None
    assert len(make_file("text/plain", b"x").tag) == 32


def test_files_of_the_last_folder_count_and_hidden_ones_do_not(tmp_path: Path) -> None:
    for name in ("one/index.html", "one/a/main.js", "two/index.html", "two/.git/x", "two/__pycache__/x.pyc"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(name, encoding="utf-8")
    files = read_files(tmp_path / "one", tmp_path / "two")
    assert sorted(files) == ["", "a/main.js", "index.html"]
    assert files["index.html"].plain == b"two/index.html"
    assert files["a/main.js"].kind == "text/javascript; charset=utf-8"


@pytest.mark.parametrize("name", ["index.html", "x.exe", "link.js"])
def test_a_folder_without_a_page_or_with_other_files_is_refused(tmp_path: Path, name: str) -> None:
    if name != "index.html":
        (tmp_path / "index.html").write_text("", encoding="utf-8")
    if name == "x.exe":
        (tmp_path / name).write_text("", encoding="utf-8")
    if name == "link.js":
        (tmp_path / name).symlink_to("/etc/passwd")
    with pytest.raises(ConfigError, match="expected a page"):
        read_files(tmp_path)


async def test_a_file_is_sent_as_the_browser_takes_it_and_once(server: Server) -> None:
    tags = []
    for encoding, is_packed in (("gzip", True), ("identity", False)):
        async with server.client.get("/main.js", headers={"Accept-Encoding": encoding}) as told:
            assert (told.headers.get("Content-Encoding") == "gzip") == is_packed
            assert (told.headers["Vary"], told.headers["Cache-Control"]) == ("Accept-Encoding", "no-cache")
            assert await told.text() == "export const one = 1;\n" * 100
            tags.append(told.headers["ETag"])
    assert tags[0] != tags[1]
    headers = {"If-None-Match": tags[0], "Accept-Encoding": "gzip"}
    async with server.client.get("/main.js", headers=headers) as told:
        assert told.status == 304
