"""The packages that this one needs, checked before they are used."""
from __future__ import annotations

import importlib
import sys

NEEDED = (('websockets', 10), ('flatbuffers', 2))  # module, least major version


def _remedy(name: str) -> str:
    return (f"Debian's package python3-{name} is for /usr/bin/python3; for another Python: "
            f'{sys.executable} -m pip install {name}')


def check() -> None:
    for name, least in NEEDED:
        line = f'brume needs the module {name}, version {least} or newer, in {sys.executable}'
        try:
            module = importlib.import_module(name)
        except ImportError as error:
            raise ImportError(f'{line}: it is missing. {_remedy(name)}') from error
        version = getattr(module, '__version__', '0')
        if int(version.split('.')[0]) < least:
            raise ImportError(f'{line}: here is {version}. {_remedy(name)}')
