"""Which server a connection goes to: the one that was asked for, or the one that a goodbye named."""
from __future__ import annotations

from typing import Optional

from brume import messages
from brume.address import going_on, socket_address
from brume.kinds import Table

LONGEST_ASKED = 300  # s; the longest wait that a server may ask for


class Destination:
    def __init__(self, url: str) -> None:
        self.address = socket_address(url)
        self._other: Optional[str] = None  # the server that sent us here, or to which it sent us; None: there is one
        self._go_to: Optional[str] = None  # of the last goodbye: where to go on
        self._asked = 0.0  # s to wait before

    @property
    def sent_on(self) -> bool:
        """True: the last goodbye named a server, and move() has not gone there yet."""
        return self._go_to is not None

    def hear(self, goodbye: Table) -> None:
        self._go_to = going_on(self.address, messages.text_of(goodbye.GoTo()))
        wait = goodbye.RetryAfterS()
        self._asked = min(wait, LONGEST_ASKED) if wait > 0 else 0.0

    def move(self, welcomed: bool) -> float:
        """Turns to the server that the last goodbye named, or back when nobody lets us in there. welcomed: the session
        that ended had a welcome. Returns the wait that the goodbye asks for, in s."""
        go_to, asked = self._go_to, self._asked
        self._go_to, self._asked = None, 0.0
        if go_to and go_to != self.address:
            self.address, self._other = go_to, self.address
        elif self._other and not welcomed:
            self.address, self._other = self._other, self.address
        return asked
