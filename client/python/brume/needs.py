"""The packages that this one needs, checked before they are used."""
import importlib

NEEDED = (('websockets', 10), ('flatbuffers', 2))  # module, least major version


def check():
    for name, least in NEEDED:
        line = f'brume needs the module {name}, version {least} or newer (on Debian: python3-{name})'
        try:
            module = importlib.import_module(name)
        except ImportError as error:
            raise ImportError(f'{line}: it is missing') from error
        version = getattr(module, '__version__', '0')
        if int(version.split('.')[0]) < least:
            raise ImportError(f'{line}: here is {version}')
