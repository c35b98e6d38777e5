"""A broken force record of any program is refused with its name, its line and what is wrong with it."""

import numpy as np
import pytest

from hypernode.dic.forces.checks import check_units
from hypernode.dic.forces.record import read_force_record
from tests.dic.records import RECORDS, text
from tests.dic.refusals import refused

#: Programs that write a unit behind the name, as Force_N.
WITH_SUFFIX = ("cellscale_biotester", "cellscale_univert", "pictures_suffix", "usual_names_suffix")
TIME = 0.25 * np.arange(12)
FORCE = 1.5 + 8.0 * TIME - TIME**2


class Broken:
    """The lines of a record, to be broken."""

    def __init__(self, folder, name):
        self.name, self.record, self.path = name, RECORDS[name], folder / "force.csv"
        self.lines = text(name, TIME, 0.1 * TIME, FORCE).split("\n")[:-1]
        self.head = len(self.record.head.split("\n"))
        self.names = self.head - 1 - self.record.units

    def cells(self, change, lines):
        sign = self.record.delimiter
        for k in lines:
            self.lines[k] = sign.join(change(self.lines[k].split(sign)))

    def samples(self):
        return range(self.head, len(self.lines))

    def written(self, number):
        return f"{number}".replace(".", self.record.decimal)

    def save(self, content=None):
        self.path.write_bytes("\n".join([*self.lines, ""]).encode() if content is None else content)


def with_cell(at, value):
    def change(cells):
        return [*cells[:at], value(cells[at]) if callable(value) else value, *cells[at + 1 :]]

    return change


def cut_within_a_line(broken):
    line = broken.lines[-1]
    broken.save("\n".join([*broken.lines[:-1], line[: line.index(broken.record.delimiter) + 1]]).encode())


def a_word_for_a_force(broken):
    broken.cells(with_cell(broken.record.force, "overload"), [broken.head + 3])
    broken.save()


def a_force_that_is_infinite(broken):
    broken.cells(with_cell(broken.record.force, "inf"), [broken.head + 3])
    broken.save()


def a_force_that_is_too_large_for_a_number(broken):
    broken.cells(with_cell(broken.record.force, "1e400"), [broken.head + 3])
    broken.save()


def time_that_goes_back(broken):
    lines, k = broken.lines, broken.head
    lines[k + 2], lines[k + 6] = lines[k + 6], lines[k + 2]
    broken.save()


def two_records_in_one_file(broken):
    broken.lines = [*broken.lines, *broken.lines[broken.names :]]
    broken.save()


def no_column_of_force(broken):
    at = broken.record.force
    broken.cells(lambda cells: cells[:at] + cells[at + 1 :], range(broken.names, len(broken.lines)))
    broken.save()


def a_cell_too_many(broken):
    broken.cells(lambda cells: [*cells, "7"], [broken.head + 4])
    broken.save()


def a_quote_that_does_not_end(broken):
    broken.cells(lambda cells: [*cells[:-1], '"' + cells[-1].strip('"')], [broken.head + 4])
    broken.save()


def another_delimiter(broken):
    broken.lines = [line.replace(broken.record.delimiter, "|") for line in broken.lines]
    broken.save()


def both_decimal_signs(broken):
    broken.cells(with_cell(broken.record.force, '"1.75"'), [broken.head + 4])
    broken.cells(with_cell(broken.record.force, '"2,25"'), [broken.head + 5])
    broken.save()


def thousands_or_decimals(broken):
    """Whole numbers of time, and forces with a comma before three digits."""
    for number, k in enumerate(broken.samples()):
        if broken.record.time is not None:
            broken.cells(with_cell(broken.record.time, f"{number}"), [k])
        broken.cells(lambda cells: [c if at < broken.record.force else '"1,234"' for at, c in enumerate(cells)], [k])
    broken.save()


def _renamed(cell, name):
    """The cell of a name with its unit in brackets, in quotes where it had them."""
    quote = '"' if cell.startswith('"') else ""
    return f"{quote}{cell.strip(chr(34)).split(' [')[0].split(' (')[0]} [{name}]{quote}"


def unit(broken, at, name):
    """Another unit of a column, wherever its program says it."""
    if broken.record.units:
        broken.cells(with_cell(at, name), [broken.names + 1])
    elif broken.name in WITH_SUFFIX:
        broken.cells(with_cell(at, lambda cell: f"{cell.rsplit('_', 1)[0]}_{name}"), [broken.names])
    else:
        broken.cells(with_cell(at, lambda cell: _renamed(cell, name)), [broken.names])


def a_force_in_poundals(broken):
    unit(broken, broken.record.force, "pdl")
    broken.save()


def a_force_in_volts(broken):
    unit(broken, broken.record.force, "V")
    broken.save()


def a_force_without_unit(broken):
    unit(broken, broken.record.force, "")
    broken.save()


def units_that_are_swapped(broken):
    unit(broken, broken.record.force, "s")
    if broken.record.time is not None:
        unit(broken, broken.record.time, "N")
    broken.save()


def empty(broken):
    broken.save(b"")


def only_a_header(broken):
    broken.lines = broken.lines[: broken.head]
    broken.save()


def zero_bytes(broken):
    broken.save(bytes(range(256)) * 8)


def noise(broken):
    broken.save(np.random.default_rng(4).integers(1, 256, 3000, dtype=np.uint8).tobytes())


def utf_16_without_its_mark(broken):
    broken.save("\n".join(broken.lines).encode("utf-16-le"))


NO_HEADER = "are no known names of a force and of a time or picture, and the header is of no known program"
#: Some write the volts of the load cell beside its force.
VOLTS = "is in volts, not calibrated: export the force in N"
NO_SAMPLES = "needs a header, a line of units and at least one sample"
#: Fault -> what is said of it, and whether a line is named.
FAULTS = {
    cut_within_a_line: ("not a sample", True),
    a_word_for_a_force: ("not a sample: .*overload", True),
    a_force_that_is_infinite: ("not a sample|not finite", True),
    a_force_that_is_too_large_for_a_number: ("not finite: .*1e400", True),
    time_that_goes_back: ("time goes back from|pictures go back from", True),
    two_records_in_one_file: ("not a sample|names no picture|fit force_set", None),
    no_column_of_force: (f"{NO_HEADER}|no columns in N|{VOLTS}", True),
    a_cell_too_many: (r"not a sample: \d+ cells, the header has \d+, as with decimal commas", True),
    a_quote_that_does_not_end: ("a quoted cell does not end in its line", True),
    another_delimiter: (NO_HEADER, True),
    both_decimal_signs: (r"'.*\..*' has a decimal point and '.*,.*' in line \d+ a decimal comma", True),
    thousands_or_decimals: ("'1,234' may have a decimal comma or thousands", True),
    a_force_in_poundals: (f"must give force in .*found 'pdl'|no columns in N|{VOLTS}", True),
    a_force_in_volts: (VOLTS, True),
    a_force_without_unit: (f"must give force in .*found ''|no columns in N|{NO_HEADER}|{VOLTS}", True),
    units_that_are_swapped: (rf"must give (force|time) in .*found '[sN]'|no columns in N|{VOLTS}", True),
    empty: (NO_SAMPLES, False),
    only_a_header: (NO_SAMPLES, False),
    zero_bytes: ("cannot be read as text: it holds zero bytes", False),
    noise: (NO_HEADER, True),
    utf_16_without_its_mark: ("cannot be read as text: it holds zero bytes", False),
}


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.__name__)
@pytest.mark.parametrize("name", RECORDS)
def test_a_broken_record_is_refused_with_its_reason(tmp_path, name, fault):
    broken = Broken(tmp_path, name)
    fault(broken)
    words, line = FAULTS[fault]
    with refused(broken.path, words, line):
        read_force_record(broken.path)


@pytest.mark.parametrize("cell", ["", "nan"])
@pytest.mark.parametrize("name", RECORDS)
def test_a_row_whose_force_is_missing_is_no_sample(tmp_path, name, cell):
    broken = Broken(tmp_path, name)
    broken.save()
    whole = read_force_record(broken.path)
    broken.cells(with_cell(broken.record.force, cell), [broken.head + 3])
    broken.save()
    if len(whole.axes) > 1:
        with refused(broken.path, "not a sample|not finite", True):
            read_force_record(broken.path)
        return
    np.testing.assert_allclose(read_force_record(broken.path).force, np.delete(whole.force, 3, axis=0))


@pytest.mark.parametrize("name", RECORDS)
@pytest.mark.parametrize("factor", [1e3, 1e-3])
def test_a_record_whose_unit_changes_under_way_is_refused(tmp_path, name, factor):
    time = np.linspace(0.0, TIME[-1], 60)
    force = np.interp(time, TIME, FORCE)
    for half, said in ((time > 1.4, [True]), (time < -1.0, [])):
        path = tmp_path / "force.csv"
        path.write_text(text(name, time, 0.1 * time, np.where(half, factor, 1.0) * force))
        record = read_force_record(path)
        samples = record.image if record.time is None else record.time
        findings = check_units(samples, record.force[:, record.column("x")])
        assert [finding.refused for finding in findings] == said
        assert all("a factor of 1000 between two samples: the unit changes" in each.sentence for each in findings)
