"""clang-tidy over many files: those that it has read as they are now are not read again.

tidy.py BUILD JOBS FILE...: BUILD has compile_commands.json, and keeps in BUILD/read what was read without a finding.
"""
import concurrent.futures
import hashlib
import json
import pathlib
import shlex
import subprocess
import sys

SAYS_EVERY = 25  # files


def preprocessed(command: dict) -> bytes:
    """The source with all that it includes and its comments, which may be NOLINT."""
    words = shlex.split(command["command"])
    at = words.index("-o")
    del words[at : at + 2]
    words[words.index("-c")] = "-E"
    return subprocess.run([*words, "-C"], cwd=command["directory"], check=True, capture_output=True).stdout


def main() -> int:
    build, jobs, files = pathlib.Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3:]
    commands = {c["file"]: c for c in json.loads((build / "compile_commands.json").read_text())}
    rules = subprocess.run(["clang-tidy", "--version"], check=True, capture_output=True).stdout
    rules += pathlib.Path(".clang-tidy").read_bytes()
    read = build / "read"
    read.mkdir(exist_ok=True)

    def tidy(file: str) -> tuple[bool, bool, str]:  # known, clean, findings
        command = commands.get(str(pathlib.Path(file).resolve()))
        if command is None:
            return False, False, f"{file}: no target compiles it\n"
        stamp = read / hashlib.sha256(rules + preprocessed(command)).hexdigest()
        if stamp.exists():
            return True, True, ""
        ran = subprocess.run(["clang-tidy", "--quiet", "-p", build, file], capture_output=True, text=True)
        clean = ran.returncode == 0 and not ran.stdout.strip()
        if clean:
            stamp.write_text(file)
        return False, clean, ran.stdout + (ran.stderr if ran.returncode else "")

    done = known = wrong = 0
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for was_known, clean, findings in pool.map(tidy, files):
            done, known, wrong = done + 1, known + was_known, wrong + (not clean)
            print(findings, end="")
            if done % SAYS_EVERY == 0 or done == len(files):
                print(f"   {done} of {len(files)} files, {known} of them read before, {wrong} with findings", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
