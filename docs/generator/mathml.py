"""Formulas as MathML, which browsers draw by themselves: no script, no font, nothing from elsewhere."""

from collections.abc import Callable

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.util import logging

LOGGER = logging.getLogger(__name__)


def formula(latex: str, display: str) -> str:
    """MathML of a formula.

    Args:
        latex: without dollar signs.
        display: ``inline`` or ``block``.

    Raises:
        ValueError: a command is not known, which the converter would show as it is written.
    """
    found = convert(latex, display=display)
    if "\\" in found:
        raise ValueError(f"the formula {latex!r} has a command that is not known")
    return found


def _visit(display: str) -> Callable:
    def visit(writer, node):
        try:
            written = formula(node.astext(), display)
        except Exception as error:
            # The converter has many errors of its own, and a build that is strict ends with any of them.
            LOGGER.warning("%s", error, location=node)
            raise nodes.SkipNode from error
        writer.body.append(written if display == "inline" else f'<div class="math">{written}</div>\n')
        raise nodes.SkipNode

    return visit


def setup(app) -> dict[str, bool]:
    """Tell Sphinx of the renderer ``mathml``."""
    app.add_html_math_renderer("mathml", (_visit("inline"), None), (_visit("block"), None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
