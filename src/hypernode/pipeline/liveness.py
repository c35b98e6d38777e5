"""Who is at work in a folder that many machines share, told by signs of life in the folder itself.

A number of a process says nothing on another machine, and clocks of machines differ. So whoever works counts in a file
of its own, and whoever asks looks twice.
"""

import contextlib
import platform
import secrets
import threading
import time
from pathlib import Path

#: Where the files are, relative to the folder of a run: beside Snakemake's own lock.
FOLDER = Path(".snakemake") / "alive"
#: Time between two counts [s]: few enough for thousands of jobs on one file system.
BEAT = 5.0
#: Time in which somebody who is at work has counted [s]: three beats, since a busy file system is late.
WATCH = 3 * BEAT


@contextlib.contextmanager
def shown_alive(what: str, folder: Path = FOLDER, beat: float = BEAT):
    """Count in a file of this folder while the block runs; nowhere where the folder above it is absent.

    Args:
        what: who is at work, in words.
        folder: where the files are.
        beat: time between two counts [s].
    """
    sign, over = folder.absolute() / secrets.token_hex(8), threading.Event()

    def show(beats: int):
        # A full disk stops nobody from working. Renamed into place, so that whoever reads meanwhile reads all of it.
        with contextlib.suppress(OSError):
            sign.parent.mkdir(exist_ok=True)
            _draft(sign).write_text(f"{what} on {platform.node()}\n{beats}\n", encoding="utf-8")
            _draft(sign).replace(sign)

    def count():
        beats = 0
        while not over.wait(beat):
            beats += 1
            show(beats)

    # Whoever asks from now on finds it, however late the other thread begins.
    show(0)
    counting = threading.Thread(target=count, daemon=True)
    counting.start()
    try:
        yield
    finally:
        over.set()
        counting.join()
        _take_away(sign)


def at_work(folder: Path = FOLDER, watch: float = WATCH) -> list[str]:
    """Who counts on in a folder, in words; signs of those who do not are taken away. Without any, it takes no time.

    Args:
        folder: where the files are.
        watch: how long to look [s].
    """
    before = _counts(folder)
    if before:
        time.sleep(watch)
    after = _counts(folder)
    alive = {sign for sign, text in after.items() if text != before.get(sign)}
    for sign in set(after) - alive:
        _take_away(sign)
    return sorted(after[sign].partition("\n")[0] for sign in alive)


def _draft(sign: Path) -> Path:
    return sign.with_name(f".{sign.name}")


def _take_away(sign: Path):
    for each in (sign, _draft(sign)):
        with contextlib.suppress(OSError):
            each.unlink(missing_ok=True)


def _counts(folder: Path) -> dict[Path, str]:
    found = {}
    for sign in sorted(folder.glob("[!.]*")):
        with contextlib.suppress(OSError):
            found[sign] = sign.read_text(encoding="utf-8")
    return found
