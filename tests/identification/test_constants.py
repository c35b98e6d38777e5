"""By what an identification decides stands in one place, and no number that was chosen stands elsewhere."""

import ast
from pathlib import Path

from docs.generator.constants import MODULES, constants
from tests.documentation.prose import sentences, words

FOLDER = Path(__file__).resolve().parents[2] / "src/hypernode/identification"
#: Constants that nobody chose: points of Gauss, counts of forces, sides and degrees, a unit, lengths along a grid.
FACTS = {
    *("camera._GAUSS", "cellwise.CELL_FORCES", "finer_grid.SIDES", "gradual.DEGREE", "homogeneous.PERCENT"),
    *("regulariser.SIDE_SHARE", "regulariser.CORNER_SHARE"),
}
#: What a number may be made by.
MADE_BY = {"np", "float", "int"}


def of(module):
    return constants((FOLDER / f"{module}.py").read_text())


def is_number(node):
    """Whether an expression is a number or several, of literals and functions of them alone."""
    parts = list(ast.walk(node))
    literals = [part.value for part in parts if isinstance(part, ast.Constant)]
    names = {part.id for part in parts if isinstance(part, ast.Name)}
    return bool(literals) and all(isinstance(each, int | float) for each in literals) and names <= MADE_BY


def numbers(text):
    """Names in upper case at the top of a module that are numbers."""
    found = []
    for node in ast.parse(text).body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None and is_number(node.value):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names = [part.id for target in targets for part in ast.walk(target) if isinstance(part, ast.Name)]
            found += [name for name in names if name.isupper()]
    return found


def test_numbers_are_told_from_names_and_from_what_is_made_of_other_constants():
    text = "A, B = 1, (2.0, 3)\n_C: float = np.sqrt(2.0) / 3\nd = 4\nE = 2 * A\nF = ('x',)\nG = {'x': 1.0}\nH = 2**20\n"
    assert numbers(text) == ["A", "B", "_C", "H"]


def test_at_most_forty_thresholds_decide():
    assert len(of("thresholds")) <= 40


def test_numbers_that_were_chosen_stand_in_four_modules_alone():
    others = [path for path in FOLDER.glob("*.py") if path.stem not in MODULES]
    assert {f"{path.stem}.{name}" for path in others for name in numbers(path.read_text())} == FACTS


def test_no_two_constants_have_one_name():
    names = [each.name for module in MODULES for each in of(module)]
    assert len(set(names)) == len(names)


def test_no_sentence_of_a_reason_must_be_read_twice():
    reasons = [each.reason for module in MODULES for each in of(module)]
    assert [each for reason in reasons for each in sentences(reason) if words(each) > 30] == []
