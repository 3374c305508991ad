"""The fence."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from companion.failsafe.inputs import FailsafeInputs


def fence_breached(signs: "FailsafeInputs") -> str:
    """The boat is beyond a line."""
    return f"Outside the fence by {signs.fence.beyond_m:.1f} m" if signs.fence.is_outside else ""
