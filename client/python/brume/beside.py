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

    from brume.link import Link


def _line(answer: urllib.error.HTTPError) -> str:
    return answer.read(1000).decode('utf-8', 'replace').split('\n')[0]


def _ask(request: urllib.request.Request, token: Optional[str], tls: Optional[ssl.SSLContext], timeout: float) -> bytes:
    if token:
        request.add_header('Authorization', f'Bearer {token}')
    with urllib.request.urlopen(request, timeout=timeout, context=tls) as answer:
        data: bytes = answer.read()
        return data


def ask(link: Link, route: str, query: Dict[str, Any], body: Optional[bytes], timeout: float) -> bytes:
    """Asks a viewer's server for something; raises BrumeError with its line if it refuses. Returns the answer. body:
    bytes to POST; None gets. timeout: s."""
    address = page_address(link.address, f'{route}?{urllib.parse.urlencode(query)}')
    try:
        return _ask(urllib.request.Request(address, data=body, method='GET' if body is None else 'POST'), link.token,
                    link.tls, timeout)
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
