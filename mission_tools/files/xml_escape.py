"""Text for XML."""

import re
from html import escape

_NOT_IN_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # XML 1.0, 2.2


def escaped(text: str) -> str:
    """Text as it may stand in an element or a quoted attribute; characters that XML forbids are left out."""
    return escape(_NOT_IN_XML.sub("", text))
