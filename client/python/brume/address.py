"""Addresses of servers."""
from __future__ import annotations

import urllib.parse
from typing import Optional

from brume.error import BrumeError


def socket_address(url: str) -> str:
    """The address of the socket beside a page: http://host:8080 gives ws://host:8080/ws.

    A last part of a path without a dot is a folder: https://host/clouds/brume gives wss://host/clouds/brume/ws."""
    parts = urllib.parse.urlsplit(url if '://' in url else f'http://{url}')
    schemes = {'http': 'ws', 'https': 'wss', 'ws': 'ws', 'wss': 'wss'}
    if parts.scheme not in schemes or not parts.hostname:
        raise BrumeError(f'{url!r} is no address of a server: http://HOST:PORT or wss://HOST:PORT/ws')
    path = parts.path or '/'
    if '.' not in path.rsplit('/', 1)[-1] and not path.endswith(('/', '/ws')):
        path += '/'
    path = path if path.endswith('/ws') else urllib.parse.urljoin(path, 'ws')
    return urllib.parse.urlunsplit((schemes[parts.scheme], parts.netloc, path, '', ''))


def page_address(url: str, name: str = '') -> str:
    """The address of a page or file beside a socket: ws://host:8080/ws gives http://host:8080/NAME."""
    return urllib.parse.urljoin('http' + socket_address(url)[2:], name or '.')


def going_on(address: str, go_to: str) -> Optional[str]:
    """The socket that a goodbye from `address` sends to, or None: for what is no URL, and from TLS to none."""
    try:
        to = socket_address(go_to) if '://' in go_to else None
    except (BrumeError, ValueError):
        return None
    return None if not to or (address.startswith('wss:') and not to.startswith('wss:')) else to
