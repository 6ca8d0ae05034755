#!/usr/bin/env python3
"""Packs this folder as a wheel: packing.py FOLDER. Also pip's way to build it (PEP 517). Equal files give equal
bytes."""
import base64
import hashlib
import pathlib
import sys
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
BEGIN = (1980, 1, 1, 0, 0, 0)  # the time of every file in it
SAID = 'Wheel-Version: 1.0\nGenerator: brume\nRoot-Is-Purelib: true\nTag: py3-none-any\n'


def _files(head, described):
    """(name in the wheel, bytes) of all files but the record."""
    for path in sorted((HERE / 'brume').rglob('*')):
        if path.is_file() and '__pycache__' not in path.parts:
            yield path.relative_to(HERE).as_posix(), path.read_bytes()
    yield f'{described}/METADATA', f'{head}\n{(HERE / "README.md").read_text("utf-8")}'.encode()
    yield f'{described}/WHEEL', SAID.encode()
    for name in ('LICENSE', 'NOTICE'):
        yield f'{described}/{name}', (HERE / name).read_bytes()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Writes the wheel, and returns its name."""
    head = (HERE / 'METADATA').read_text('utf-8')
    fields = dict(line.split(': ', 1) for line in head.splitlines())
    stem = f'{fields["Name"]}-{fields["Version"]}'
    described, name, record = f'{stem}.dist-info', f'{stem}-py3-none-any.whl', ''
    folder = pathlib.Path(wheel_directory)
    folder.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(folder / name, 'w', zipfile.ZIP_DEFLATED) as wheel:
        def add(at, data):
            entry = zipfile.ZipInfo(at, BEGIN)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o100644 << 16
            wheel.writestr(entry, data)
        for at, data in _files(head, described):
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip('=')
            record += f'{at},sha256={digest},{len(data)}\n'
            add(at, data)
        add(f'{described}/RECORD', f'{record}{described}/RECORD,,\n')
    return name


def build_sdist(sdist_directory, config_settings=None):
    raise SystemExit('packing.py makes wheels alone: the sources are those of the project')


if __name__ == '__main__':
    print(pathlib.Path(sys.argv[1]) / build_wheel(sys.argv[1]))
