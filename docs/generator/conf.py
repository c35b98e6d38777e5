"""What Sphinx is told of the site."""

import tomllib
from pathlib import Path

_project = tomllib.loads((Path(__file__).resolve().parents[2] / "pyproject.toml").read_text(encoding="utf-8"))[
    "project"
]

project = "hypernode"
author = _project["authors"][0]["name"]
version = release = _project["version"]
language = "en"

root_doc = "docs/index"
extensions = ["myst_parser", "docs.generator.mathml"]
myst_enable_extensions = ["dollarmath"]
# Headings down to the third level can be linked to.
myst_heading_anchors = 3
html_math_renderer = "mathml"
html_theme = "furo"
html_title = f"hypernode {version}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_copyright = False
html_show_sourcelink = False
html_copy_source = False
pygments_style = "default"
