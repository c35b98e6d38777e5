"""The page of what Python programs may call, from the docstrings, which are read and not imported."""

import ast
import textwrap
from pathlib import Path

from sphinx.ext.napoleon import Config, GoogleDocstring

#: (name that is shown, module, name there, its public methods or none) of everything that is meant to be called.
PUBLIC = (
    ("hypernode.load_material", "material/files.py", "load_material", False),
    ("hypernode.material.field.Material", "material/field.py", "Material", True),
    ("hypernode.stages.advice.run", "stages/advice.py", "run", False),
    ("hypernode.advice.further_test.Advice", "advice/further_test.py", "Advice", False),
    ("hypernode.advice.further_test.FurtherTest", "advice/further_test.py", "FurtherTest", False),
    ("hypernode.storage.netcdf.read", "storage/netcdf.py", "read", False),
)
_SETTINGS = Config(napoleon_use_ivar=True, napoleon_use_rtype=False)


def page(package: Path) -> str:
    """The page in MyST Markdown, its definitions in reStructuredText.

    Args:
        package: folder of the package.
    """
    lines = [
        "# Python interface",
        "",
        "What a program may call. Everything else may change from one version to the next.",
        "",
        'Shapes are written as `Float[Array, "n 2"]`: an array of floating-point numbers, `n` rows and two columns.',
        "",
        "```{eval-rst}",
    ]
    for shown, file, name, methods in PUBLIC:
        lines += _definition(shown, _find(ast.parse((package / file).read_text(encoding="utf-8")), name), methods)
    return "\n".join([*lines, "```", ""])


def _find(tree: ast.Module, name: str) -> ast.FunctionDef | ast.ClassDef:
    return next(node for node in tree.body if getattr(node, "name", None) == name)


def _definition(shown: str, node: ast.FunctionDef | ast.ClassDef, methods: bool) -> list[str]:
    kind = "class" if isinstance(node, ast.ClassDef) else "function"
    signature = "" if kind == "class" else _signature(node)
    lines = [f".. py:{kind}:: {shown}{signature}", "", *_indented(_docstring(node, kind)), ""]
    for method in node.body if methods else ():
        if isinstance(method, ast.FunctionDef) and not method.name.startswith("_"):
            described = [
                f".. py:method:: {method.name}{_signature(method)}",
                "",
                *_indented(_docstring(method, "method")),
            ]
            lines += [*_indented("\n".join(described)), ""]
    return lines


def _signature(node: ast.FunctionDef) -> str:
    arguments = ast.unparse(node.args)
    own = arguments.removeprefix("self").removeprefix(", ")
    return f"({own})" + (f" -> {ast.unparse(node.returns)}" if node.returns else "")


def _docstring(node: ast.AST, kind: str) -> str:
    return str(GoogleDocstring(ast.get_docstring(node), _SETTINGS, what=kind))


def _indented(text: str) -> list[str]:
    return textwrap.indent(text, "   ").splitlines()
