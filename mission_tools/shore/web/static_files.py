"""The page's files, read once at start: nothing else of the disk can be asked for."""

import gzip
import hashlib
import re
from pathlib import Path
from typing import Final, NamedTuple

from aiohttp import web

from companion.core.errors import ConfigError

_TYPES: Final = {
    ".css": "text/css; charset=utf-8",
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".json": "application/json",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".webmanifest": "application/manifest+json",
}
_LANGUAGE: Final = re.compile(r"words\.([a-z]{2,3}(?:-[A-Za-z0-9]{1,8})*)\.json")
_LANGUAGES: Final = b'data-languages="en"'  # in index.html: the page then need not ask for them


class StaticFile(NamedTuple):
    """packed: gzip, or None where it saves nothing. tag: of the content."""

    kind: str
    plain: bytes
    packed: bytes | None
    tag: str


def make_file(kind: str, plain: bytes) -> StaticFile:
    """Hash and pack a content."""
    packed = gzip.compress(plain, 9, mtime=0)
    tag = hashlib.sha256(plain).hexdigest()[:32]
    return StaticFile(kind, plain, packed if len(packed) < 0.9 * len(plain) else None, tag)


def read_files(*folders: Path) -> dict[str, StaticFile]:
    """The files below the folders by their path, the last one's of two with the same.

    index.html is there as the empty name as well, and with the page's languages. ConfigError without a page,
    or with a file of another type.
    """
    files: dict[str, StaticFile] = {}
    for folder in folders:
        for path in sorted(folder.rglob("*")):
            name = path.relative_to(folder)
            if any(part.startswith((".", "__")) for part in name.parts) or path.is_dir():
                continue
            kind = _TYPES.get(path.suffix)
            if kind is None or path.is_symlink() or not path.is_file():
                raise ConfigError(f"{path}: expected a page's file: {', '.join(_TYPES)}")
            files[name.as_posix()] = make_file(kind, path.read_bytes())
    if "index.html" not in files:
        raise ConfigError(f"{folders[-1]}: expected a page with index.html")
    languages = " ".join(match[1] for name in files if (match := _LANGUAGE.fullmatch(name)))
    plain = files["index.html"].plain.replace(_LANGUAGES, f'data-languages="{languages}"'.encode())
    files[""] = files["index.html"] = make_file(_TYPES[".html"], plain)
    return files


def respond(request: web.Request, file: StaticFile) -> web.Response:
    """The file, packed if the browser takes it; 304 if it has it already."""
    is_packed = file.packed is not None and "gzip" in request.headers.get("Accept-Encoding", "")
    tag = f'"{file.tag}-gzip"' if is_packed else f'"{file.tag}"'
    headers = {"ETag": tag, "Cache-Control": "no-cache", "Vary": "Accept-Encoding"}
    if tag in request.headers.get("If-None-Match", ""):
        return web.Response(status=304, headers=headers)
    headers["Content-Type"] = file.kind
    if is_packed:
        headers["Content-Encoding"] = "gzip"
    return web.Response(body=file.packed if is_packed else file.plain, headers=headers)
