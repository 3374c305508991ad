"""Messages of our dialect of which a test names only the fields that matter."""

from typing import Any

from companion.mavlink.dialect import Message, dialect


def blank(kind: str, **values: Any) -> Message:  # noqa: ANN401 (any field)
    """A message of a kind, such as sys_status; what is not given is 0."""
    build = getattr(dialect, f"MAVLink_{kind}_message")
    message: Message = build(**(dict.fromkeys(build.fieldnames, 0) | values))
    return message
