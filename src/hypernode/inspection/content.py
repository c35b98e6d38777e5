"""Which files of a folder are frames, which are pictures, and which may be force records."""

from dataclasses import dataclass
from pathlib import Path

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.array_files import SUFFIXES as ARRAYS
from hypernode.dic.errors import DicError
from hypernode.dic.folder import SUFFIXES, Found, dialect_of, find_series
from hypernode.dic.header import HEAD_BYTES, bare, layout_of
from hypernode.dic.text import read_text
from hypernode.dic.validity import known_columns

#: Endings of records beside those of tables: Zwick, LabVIEW, loggers and printers to a file.
_RECORDS = {".tra", ".lvm", ".log", ".prn"}
#: Endings of what cameras write.
PICTURES = {".tif", ".tiff", ".jpg", ".jpeg", ".png", ".bmp"}


@dataclass(frozen=True, kw_only=True)
class Content:
    """The files of a folder.

    Attributes:
        folder: which one.
        frames: the one series of displacement files; None where there is none or not one.
        refusal: why not; empty where there is one.
        pictures: in the order of their names.
        tables: files that are no frames and may be force records.
    """

    folder: Path
    frames: Found | None
    refusal: str
    pictures: tuple[Path, ...]
    tables: tuple[Path, ...]


def content_of(test: SpecimenTest) -> Content:
    """What lies in the folder of a test."""
    folder = Path(test.folder)
    files = sorted(path for path in folder.iterdir() if path.is_file())
    pictures = tuple(path for path in files if path.suffix.lower() in PICTURES)
    try:
        found, refusal = find_series(folder, dialect_of(test)), ""
    except DicError as error:
        found, refusal = None, _without_displacements(pictures) or str(error)
    frames = set(found.files.values()) if found else set()
    # No testing machine writes arrays, although displacements may stand in them.
    endings = SUFFIXES - ARRAYS | _RECORDS
    tables = tuple(path for path in files if path.suffix.lower() in endings and path not in frames)
    return Content(folder=folder, frames=found, refusal=refusal, pictures=pictures, tables=tables)


def columns_beside(found: Found) -> list[str]:
    """Columns of the first frame beside positions and displacements; of those known to tell lost points, only these."""
    if found.dialect.content != "frame":
        return []
    layout = layout_of(read_text(next(iter(found.files.values())), HEAD_BYTES).splitlines(), found.dialect)
    taken = {name for role in "xyuvzw" for name in getattr(found.dialect, role)}
    names = [] if layout is None else [bare(name) for name in layout.names if taken.isdisjoint((name, bare(name)))]
    return list(known_columns(names)) or [name for name in names if name]


def _without_displacements(pictures: tuple[Path, ...]) -> str:
    """What a folder of pictures lacks; empty where there are no pictures to speak of."""
    if len(pictures) < 2:
        return ""
    return (
        f"{pictures[0].parent}: {len(pictures)} pictures ({pictures[0].name} to {pictures[-1].name}) and no "
        "displacement files: correlate the pictures with a program for digital image correlation first, and export "
        "a table of displacements a picture into this folder"
    )
