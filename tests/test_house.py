"""The house: which package may import which, how large its rooms may be, and how what is in them is built."""

import ast
import functools
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "src" / "hypernode"
#: Package or module at the top -> what of hypernode it may import. Points, then sheets, then data, then the two ways to
#: a material, then what judges and shows it; stages and the command line join them.
ALLOWED = {
    "errors": set(),
    "installation": set(),
    "progress": set(),
    "verdict": set(),
    "trace": set(),
    "mechanics": {"errors"},
    "networks": {"errors"},
    "fem": {"errors", "mechanics"},
    "storage": {"errors", "installation"},
    "config": {"errors", "mechanics", "networks", "tables"},
    "data": {"errors", "mechanics", "fem"},
    "material": {"errors", "mechanics", "networks", "config", "storage"},
    "dic": {"errors", "installation", "progress", "mechanics", "fem", "data", "config"},
    "synthetic": {"errors", "progress", "mechanics", "fem", "data", "config"},
    "pictures": {"errors", "installation", "progress", "mechanics", "fem", "data", "config"},
    "identification": {"errors", "verdict", "trace", "progress", "mechanics", "fem", "data", "config"},
    "baselines": {"errors", "mechanics", "fem", "data"},
    "advice": {"errors", "progress", "mechanics", "fem", "data", "config", "identification"},
    "challenge": {"errors", "fem", "identification"},
    "prediction": {
        *("errors", "progress", "mechanics", "fem", "data", "material", "config", "identification"),
    },
    "polishing": {
        *("errors", "verdict", "progress", "mechanics", "networks", "fem", "data", "material", "config"),
        # The test, its equilibrium and their derivatives.
        "identification",
    },
    "training": {"errors", "progress", "mechanics", "networks", "fem", "data", "material", "config"},
    "evaluation": {
        "errors",
        "verdict",
        "progress",
        "mechanics",
        "networks",
        "fem",
        "data",
        "material",
        "synthetic",
        "config",
    },
    "inspection": {"errors", "progress", "mechanics", "data", "config", "dic"},
    "figures": {
        *("errors", "verdict", "mechanics", "fem", "data", "material", "evaluation", "storage", "tables"),
        # The figure of a folder of displacement files, which shows what was found out about it.
        "inspection",
    },
    "tables": {"errors", "verdict", "mechanics", "storage"},
    "export": {"verdict", "mechanics", "networks", "fem", "data", "material", "evaluation"},
    "explorer": {
        *("errors", "verdict", "trace", "mechanics", "fem", "data", "material", "evaluation", "storage", "tables"),
        # Colour maps, so that both have one look.
        "figures",
    },
    "pipeline": {"errors", "config", "dic", "pictures", "storage"},
    "stages": {
        *("errors", "progress", "mechanics", "networks", "fem", "storage", "config", "data", "material", "dic"),
        *(
            "verdict",
            "trace",
            "synthetic",
            "pictures",
            "identification",
            "advice",
            "prediction",
            "challenge",
            "polishing",
            "training",
            "evaluation",
        ),
        *("explorer", "baselines"),
    },
    "commands": {
        *(
            "errors",
            "installation",
            "verdict",
            "trace",
            "config",
            "mechanics",
            "synthetic",
            "inspection",
            "figures",
            "tables",
        ),
        *("pipeline", "stages", "storage", "export", "pictures", "challenge"),
    },
    "cli": {
        *("__init__", "errors", "installation", "progress", "verdict", "config", "storage", "pipeline", "tables"),
        *("stages", "commands"),
    },
    "__main__": {"cli"},
    "__init__": {"material"},
}
#: What of the configuration the two ways to a material may see: the method, and nothing of case or truth.
OWN_SECTIONS = {
    "identification": {"config.methods"},
    "advice": {"config.methods"},
    "prediction": {"config.methods"},
    "polishing": {"config.methods"},
    "training": {"config.methods"},
    "material": {"config.methods"},
}
#: Modules with names that the configuration reads, free of imports of this package.
FREE_OF_IMPORTS = {"mechanics.loads", "mechanics.parameters", "networks.terms", "tables.columns", "tables.limits"}
#: The functions of a measurement of which only stages, figures and tables may open files.
OPENING = "hypernode.storage.netcdf"


@functools.cache
def modules():
    return sorted(PACKAGE.rglob("*.py"))


@functools.cache
def nodes(path: Path) -> list[ast.AST]:
    """Every node of a file, which many tests look at."""
    return list(ast.walk(ast.parse(path.read_text())))


def room(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


@functools.cache
def imports(path: Path) -> list[tuple[int, str]]:
    """(line, module below hypernode) of every import of the package in a file, wherever it stands."""
    return list(imported(nodes(path)))


def imported(nodes: list[ast.AST]):
    for node in nodes:
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "hypernode":
            base = node.module.removeprefix("hypernode").lstrip(".")
            if base and "." not in base:
                for name in node.names:
                    inner = PACKAGE / base / f"{name.name}.py"
                    yield node.lineno, f"{base}.{name.name}" if inner.is_file() else base
            elif base:
                yield node.lineno, base
            else:
                yield from ((node.lineno, name.name) for name in node.names)
        elif isinstance(node, ast.Import):
            for name in node.names:
                if name.name.split(".")[0] == "hypernode":
                    yield node.lineno, name.name.removeprefix("hypernode").lstrip(".") or "__init__"


def test_every_room_is_known():
    assert {room(path) for path in modules()} == set(ALLOWED)


@pytest.mark.parametrize("name", sorted(ALLOWED))
def test_a_room_imports_only_what_it_may(name):
    wrong = [
        f"{path.relative_to(PACKAGE)}:{line}: imports {module}"
        for path in modules()
        if room(path) == name
        for line, module in imports(path)
        if module.split(".")[0] not in ALLOWED[name] | {name}
    ]
    assert not wrong, "\n".join(wrong)


def test_no_arrow_runs_back_up_and_none_in_a_circle():
    """The allowed arrows have an order: a room may see only rooms below it."""
    below, left = set(), dict(ALLOWED)
    while left:
        free = [name for name, seen in left.items() if seen <= below]
        assert free, f"a circle among {sorted(left)}"
        below |= set(free)
        for name in free:
            del left[name]


def test_modules_of_a_room_import_each_other_in_no_circle():
    for name in ALLOWED:
        arrows = {}
        for path in modules():
            if room(path) == name:
                module = ".".join(path.relative_to(PACKAGE).with_suffix("").parts)
                arrows[module] = {target for _, target in imports(path) if target.split(".")[0] == name}
        done: set = set()
        while arrows:
            free = [module for module, targets in arrows.items() if not (targets & set(arrows)) - {module}]
            assert free, f"a circle among {sorted(arrows)}"
            done |= set(free)
            for module in free:
                del arrows[module]


@pytest.mark.parametrize("name", sorted(OWN_SECTIONS))
def test_the_ways_to_a_material_see_no_section_of_the_configuration_but_the_method(name):
    seen = {m for path in modules() if room(path) == name for _, m in imports(path) if m.split(".")[0] == "config"}
    assert seen <= OWN_SECTIONS[name]


def test_the_configuration_reads_of_other_rooms_only_names():
    seen = {m for path in modules() if room(path) == "config" for _, m in imports(path)}
    assert {m for m in seen if m.split(".")[0] in ("mechanics", "networks", "tables")} <= FREE_OF_IMPORTS


@pytest.mark.parametrize(
    "name",
    [
        *(
            "identification",
            "baselines",
            "advice",
            "prediction",
            "challenge",
            "training",
            "evaluation",
            "synthetic",
            "data",
            "fem",
            "mechanics",
        ),
        "export",
    ],
)
def test_mathematics_opens_no_file(name):
    wrong = [
        f"{path.name}: {node.func.id if isinstance(node.func, ast.Name) else node.func.attr}"
        for path in modules()
        if room(path) == name
        for node in nodes(path)
        if isinstance(node, ast.Call)
        and (
            (isinstance(node.func, ast.Name) and node.func.id == "open")
            or (isinstance(node.func, ast.Attribute) and node.func.attr in ("open_dataset", "to_netcdf", "read_text"))
        )
    ]
    assert not wrong


#: Files and functions that are longer than they should be, each with its reason.
LONG_FILES = {
    "fem/solver.py": "one class around JAX-FEM: what it replaces there is understood together",
}
LONG_FUNCTIONS = {
    "identification/gauss_newton.py:descend": "one loop whose state would be passed to and fro",
}


def test_files_and_functions_stay_of_a_size_that_is_read_at_once():
    long = []
    for path in modules():
        text = path.read_text()
        where = str(path.relative_to(PACKAGE))
        if len(text.splitlines()) > 250 and where not in LONG_FILES:
            long.append(f"{where}: {len(text.splitlines())} lines")
        for node in nodes(path):
            if isinstance(node, ast.FunctionDef):
                length = node.end_lineno - node.lineno + 1
                if length > 60 and f"{where}:{node.name}" not in LONG_FUNCTIONS:
                    long.append(f"{where}:{node.lineno}: {node.name} has {length} lines")
    assert not long, "\n".join(long)


#: Arguments that a constructor may take by position.
BY_POSITION = 4


def classes_of(files: dict[str, list[ast.AST]]) -> list[tuple[str, ast.ClassDef]]:
    """(file, class) of every class in some files, by their nodes."""
    return [(at, node) for at, found in files.items() for node in found if isinstance(node, ast.ClassDef)]


def by_position(node: ast.ClassDef, known: dict[str, list[ast.ClassDef]]) -> int:
    """Arguments that a constructor takes by position, with those of its bases; a named tuple, to be unpacked, has none.

    Args:
        known: the classes of every name; of several, that with most arguments counts as a base.
    """
    bases = [ast.unparse(base).split(".")[-1] for base in node.bases]
    if "NamedTuple" in bases:
        return 0
    for part in node.body:
        if isinstance(part, ast.FunctionDef) and part.name == "__init__":
            return len(part.args.posonlyargs + part.args.args) - 1
    above = [by_position(one, known) for base in bases if base != node.name for one in known.get(base, [])]
    inherited = max(above, default=0)
    decorators = [ast.unparse(each) for each in node.decorator_list]
    generated = [each for each in decorators if each.split("(")[0].split(".")[-1] == "dataclass"]
    if not generated or "kw_only=True" in generated[0]:
        return inherited
    fields = 0
    for part in node.body:
        if isinstance(part, ast.AnnAssign):
            if "KW_ONLY" in ast.unparse(part.annotation):
                break
            constant, value = "ClassVar" in ast.unparse(part.annotation), part.value and ast.unparse(part.value)
            fields += not constant and "init=False" not in (value or "")
    return inherited + fields


def too_many_by_position(files: dict[str, list[ast.AST]]) -> list[str]:
    """Classes whose constructors take more arguments by position than they may."""
    known: dict[str, list[ast.ClassDef]] = {}
    found = classes_of(files)
    for _, node in found:
        known.setdefault(node.name, []).append(node)
    counts = [(at, node, by_position(node, known)) for at, node in found]
    return [f"{at}:{node.lineno}: {node.name} takes {count}" for at, node, count in counts if count > BY_POSITION]


FIVE = "    a: int\n    b: int\n    c: int\n    d: int\n    e: int = 0\n"
FOUR = FIVE.replace("    e", "    _: KW_ONLY\n    e")


@pytest.mark.parametrize(
    ("text", "refused"),
    [
        (f"@dataclass\nclass A:\n{FIVE}", "A takes 5"),
        (f"@dataclasses.dataclass(frozen=True)\nclass A:\n{FIVE}", "A takes 5"),
        (f"@dataclass\nclass A:\n{FOUR}@dataclass\nclass B(A):\n    f: int = 0\n", "B takes 5"),
        ("class A:\n    def __init__(self, a, b, c, d, e=0): ...\n", "A takes 5"),
        (f"@dataclass(kw_only=True)\nclass A:\n{FIVE}", None),
        (f"@dataclass\nclass A:\n{FOUR}", None),
        ("class A:\n    def __init__(self, a, *, b, c, d, e=0): ...\n", None),
        (f"class A(NamedTuple):\n{FIVE}", None),
    ],
)
def test_arguments_by_position_are_counted_however_a_constructor_is_written(text, refused):
    found = too_many_by_position({"file": list(ast.walk(ast.parse(text)))})
    assert [each.split(": ")[1] for each in found] == ([refused] if refused else [])


def test_no_constructor_takes_more_than_four_arguments_by_position():
    folders = [ROOT / name for name in ("src", "tests", "benchmarks", "docs", "workflow")]
    files = [path for folder in folders for path in sorted(folder.rglob("*.py"))]
    wrong = too_many_by_position({str(path.relative_to(ROOT)): nodes(path) for path in files})
    assert not wrong, "\n".join(wrong)
