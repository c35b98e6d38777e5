"""Force records, found by their content among the files of a folder."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.errors import DicError
from hypernode.dic.forces.record import ForceRecord, read_force_record
from hypernode.dic.forces.table import Table, read_table
from hypernode.inspection.known import Known, missing


@dataclass(frozen=True)
class Cycle:
    """Rows of a file that are one record: all of them, or those of one cycle.

    Attributes:
        set_name, cycle: as the file names them; None where it has no cycles.
        record: what these rows say.
    """

    set_name: str | None
    cycle: str | None
    record: ForceRecord


@dataclass(frozen=True)
class RecordFile:
    """A file whose header is that of a force record.

    Attributes:
        path: the file.
        program: what wrote it.
        cycles: its records, in the order of the file.
        refusal: why it cannot be read; empty where it can.
    """

    path: Path
    program: str
    cycles: tuple[Cycle, ...]
    refusal: str = ""


def record_files(paths: Iterable[Path], test: SpecimenTest) -> tuple[list[RecordFile], dict[Path, str]]:
    """(files with the header of a force record, sentence on each other file).

    Args:
        paths: files that may be records.
        test: whose ``force_format`` and ``force_channel`` hold for them.
    """
    found, others = [], {}
    channel = test.force_channel
    named = tuple(channel.values()) if isinstance(channel, dict) else (channel,) if channel else ()
    for path in paths:
        try:
            table = read_table(path, test.force_format, named, test.time_channel)
        except DicError as error:
            others[path] = str(error)
        else:
            found.append(_read(table, test))
    return found, others


def _read(table: Table, test: SpecimenTest) -> RecordFile:
    program = f"{table.dialect.name} ({table.dialect.program})"
    try:
        cycles = tuple(
            Cycle(*key, read_force_record(table.path, test.force_format, test.force_channel, *key, test.time_channel))
            for key in _names(table)
        )
    except DicError as error:
        return RecordFile(table.path, program, (), str(error))
    return RecordFile(table.path, program, cycles)


def _names(table: Table) -> list[tuple[str | None, str | None]]:
    """Set and cycle of every record of a file, in its order."""
    if table.dialect.cycles is None:
        return [(None, None)]
    at = [table.names.index(name) for name in table.dialect.cycles]
    return list(dict.fromkeys(tuple(cells[k].strip() for k in at) for _, cells in table.rows if len(cells) > max(at)))


def record_of_test(
    files: list[RecordFile], others: Mapping[Path, str], test: SpecimenTest, given: Mapping[str, object]
) -> tuple[RecordFile | None, Known]:
    """(the file with the forces of the test, what is known or must be said before there is one).

    Args:
        files, others: as :func:`record_files` gives them.
        test: with the default of ``force_file``.
        given: keys of the specimen that were said.
    """
    if "force_file" in given:
        name = given["force_file"]
        found = next((each for each in files if each.path.name == name), None)
        if name is None or found:
            return found, Known()
        why = next((sentence for path, sentence in others.items() if path.name == name), None)
        return None, missing(why or f"there is no file {name!r}; the folder has {_listed(files)}", "force_file")
    if len(files) == 1:
        name = files[0].path.name
        return files[0], Known({} if name == test.force_file else {"force_file": name})
    usual = next((sentence for path, sentence in others.items() if path.name == test.force_file), None)
    if not files and usual:
        return None, missing(usual, "force_file")
    if files:
        return None, missing(
            f"which force record is that of the test: {_listed(files)}: --set force_file=NAME", "force_file"
        )
    workbooks = sorted(path.name for path in Path(test.folder).glob("*.xls*"))
    table = f"; save {workbooks[0]}, which is a workbook, as CSV" if workbooks else ""
    # A way that asks for names is of a table, and a row that is none of a record; whatever else lies there is neither.
    faults = [path for path in others if "not a sample" in others[path]]
    tables = faults or [path for path in others if "force_channel" in others[path]]
    likely = max(tables, key=lambda path: path.stat().st_size, default=None)
    asked = f". If {likely.name} is it: {others[likely]}" if likely else ""
    return None, missing(
        f"there is no force record among the files{table}: put the testing machine's into the folder, or say that none "
        f"was recorded, --set force_file=null, and the material is known up to one factor{asked}",
        "force_file",
    )


def _listed(files: list[RecordFile]) -> str:
    return ", ".join(f"{each.path.name} of {each.program}" for each in files) or "no force record"


def cycle_of_test(file: RecordFile, test: SpecimenTest) -> tuple[Cycle | None, Known]:
    """(the record of the test among those of its file, what must be said before there is one)."""
    if file.refusal:
        return None, missing(file.refusal, "force_file")
    pair = (test.force_set, test.force_cycle)
    wanted = [
        each for each in file.cycles if pair[0] in (None, each.set_name) and pair[1] in (None, each.cycle)
    ]  # fmt: skip
    if len(wanted) == 1:
        return wanted[0], Known()
    which = f"{len(wanted) or 'none'} of the {len(file.cycles)} cycles in {file.path.name} may be the test"
    return None, missing(f"{which}: --set force_set=... and --set force_cycle=... as they are listed", "force_cycle")
