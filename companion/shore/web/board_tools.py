"""Where the handlers of the board find what they may do."""

from typing import Final

from aiohttp import web

from companion.shore.board.tools import BoardTools

BOARD: Final = web.AppKey("board", BoardTools)
