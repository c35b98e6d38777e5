"""Build the site: ``python -m docs.generator``, from the repository, in an environment of requirements/docs.txt."""

import argparse
import re
import shlex
import sys
from pathlib import Path

from sphinx.cmd.build import build_main

from docs.generator.assembling import assemble

ROOT = Path(__file__).resolve().parents[2]
#: The first page lies where links between pages of the repository have it; who opens the site is led there.
FIRST = '<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0; url=docs/index.html">\n'
#: What a browser would load from elsewhere: sources of scripts and images, style sheets, fonts. Links are none of it.
ELSEWHERE = re.compile(r"""(?:\ssrc=["']|<link[^>]*\shref=["']|url\(\s*["']?|@import\s+["'])(?:https?:)?//[^"')]*""")


def loads_from_elsewhere(site: Path) -> list[str]:
    """What pages and style sheets of a site load from other places, which must be nothing."""
    files = [*site.rglob("*.html"), *site.rglob("*.css")]
    found = [(path, each) for path in files for each in ELSEWHERE.findall(path.read_text(encoding="utf-8"))]
    return [f"{path.relative_to(site)}: {each}" for path, each in found]


def main() -> int:
    """Assemble the pages and build the site; any warning is an error."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--command", default="hypernode", help="words that start hypernode")
    parser.add_argument("--results", type=Path, default=ROOT / "results", help="folder whose figures are shown")
    parser.add_argument("--source", type=Path, default=ROOT / ".cache" / "docs", help="where the pages are assembled")
    parser.add_argument("--site", type=Path, default=ROOT / "site", help="where the site goes")
    arguments = parser.parse_args()
    assemble(ROOT, arguments.source, shlex.split(arguments.command), arguments.results)
    words = ["--fail-on-warning", "--keep-going", "--fresh-env", "--write-all", "--quiet", "--conf-dir"]
    code = build_main([*words, str(ROOT / "docs" / "generator"), str(arguments.source), str(arguments.site)])
    (arguments.site / "index.html").write_text(FIRST, encoding="utf-8")
    foreign = loads_from_elsewhere(arguments.site)
    for each in foreign:
        print(f"error: {each}: the site must not load anything from elsewhere", file=sys.stderr)
    return code or int(bool(foreign))


if __name__ == "__main__":
    sys.exit(main())
