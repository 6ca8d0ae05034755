"""What goes wrong."""
from __future__ import annotations


class BrumeError(Exception):
    """The server refused something, or is away. The text is the server's own line where it said one.

    code: name of the ErrorCode in brume.fbs, such as 'forbidden' or 'out_of_range'; 'connection' for the others.
    """

    def __init__(self, text: str, code: str = 'connection') -> None:
        super().__init__(text)
        self.code = code
