"""What a server is asked over HTTP, beside its socket."""
from __future__ import annotations

import urllib.error
import urllib.parse
import urllib.request
from typing import TYPE_CHECKING, Any, Dict, Optional

from brume.address import page_address
from brume.error import BrumeError

if TYPE_CHECKING:
    import ssl


def _line(answer: urllib.error.HTTPError) -> str:
    return answer.read(1000).decode('utf-8', 'replace').split('\n')[0]


def _ask(request: urllib.request.Request, token: Optional[str], tls: Optional[ssl.SSLContext], timeout: float) -> Any:
    if token:
        request.add_header('Authorization', f'Bearer {token}')
    urllib.request.urlopen(request, timeout=timeout, context=tls).close()


def post(socket: str, token: Optional[str], tls: Optional[ssl.SSLContext], route: str, query: Dict[str, str],
         body: bytes, timeout: float) -> None:
    """Asks the server of a socket for something; raises BrumeError with its line if it refuses. timeout: s."""
    address = page_address(socket, f'{route}?{urllib.parse.urlencode(query)}')
    try:
        _ask(urllib.request.Request(address, data=body, method='POST'), token, tls, timeout)
    except urllib.error.HTTPError as answer:
        code = 'forbidden' if answer.code in (401, 403) else 'unexpected'
        raise BrumeError(_line(answer) or f'HTTP {answer.code}', code) from None
    except OSError as error:
        raise BrumeError(f'no answer from {address}: {error}') from error


def why_refused(socket: str, token: Optional[str], tls: Optional[ssl.SSLContext]) -> str:
    """The server's reason to refuse the handshake, in one line, as it tells HTTP; empty if it tells none."""
    try:
        _ask(urllib.request.Request('http' + socket[2:]), token, tls, 5)
    except urllib.error.HTTPError as answer:
        return _line(answer) if answer.code in (401, 403) else ''
    except OSError:
        pass
    return ''
