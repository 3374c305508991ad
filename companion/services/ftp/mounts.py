"""Content of the file tree: parameters, metadata, version, and two folders on disk."""

import json
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path

from companion import __version__
from companion.config.parameter_pack import entries_of, pack
from companion.config.parameters import Parameters
from companion.core.storage import InlineExecutor
from companion.services.ftp import component_metadata as metadata
from companion.services.ftp.folder import FolderMount
from companion.services.ftp.tree import FileTree, Mount
from companion.services.ftp.virtual import Options, VirtualFile, VirtualMount
from companion.services.parameters import ParameterService

_MB = 1_000_000


def build_tree(
    parameters: Parameters, listings: ParameterService, folder: Path | None, quota_mb: float
) -> FileTree:
    """The file tree. folder: of files and logs, None without a disk. quota_mb: of `files`; 0: read only."""
    about = metadata.metadata_files(parameters.rows)
    version = json.dumps({"name": "mavboat", "version": __version__}).encode("ascii")
    mounts: dict[str, Mount] = {
        "@PARAM": VirtualMount({"param.pck": _packed_parameters(parameters, listings)}),
        "@SYS": VirtualMount({"version.json": VirtualFile(lambda _: version)}),
        metadata.FOLDER: VirtualMount(
            {
                metadata.GENERAL: VirtualFile(lambda _: about.general),
                metadata.PARAMETERS: VirtualFile(lambda _: about.parameters),
            }
        ),
    }
    if folder is None:
        return FileTree(mounts)
    logs = FolderMount(folder / "logs")
    mounts["files"] = FolderMount(folder / "files", quota_bytes=round(quota_mb * _MB))
    mounts["logs"] = logs
    return FileTree(mounts, aliases={"@LOGS": logs})


def open_worker(folder: Path | None) -> Executor:
    return InlineExecutor() if folder is None else ThreadPoolExecutor(1, thread_name_prefix="files")


def _packed_parameters(parameters: Parameters, listings: ParameterService) -> VirtualFile:
    def make(options: Options) -> bytes:
        entries = entries_of(parameters)
        start, count = options.whole("start"), options.whole("count")
        if start >= len(entries):
            raise options.wrong("start")
        chosen = entries[start : start + count if count else None]
        return pack(chosen, len(entries), with_defaults=options.whole("withdefaults") == 1)

    return VirtualFile(make, listings.set_from_file)
