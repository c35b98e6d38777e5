"""The page of the command line, as the commands describe themselves."""

import os
import re
import subprocess
from collections.abc import Sequence


def page(command: Sequence[str]) -> str:
    """The page in Markdown.

    Args:
        command: words that start ``hypernode``.
    """
    top = _help(command)
    names = re.search(r"\{([\w,-]+)\}", top)[1].split(",")
    lines = ["# Command line", "", "What `hypernode --help` and `hypernode COMMAND --help` say.", "", *_block(top)]
    for name in names:
        text = _help([*command, name])
        lines += [f"## hypernode {name}", "", *_block(text)]
        actions = re.search(r"^  \{([\w,-]+)\}", text, re.MULTILINE)
        # Commands of commands, such as `audit verify`; what a value may be stands in braces as well.
        for action in actions[1].split(",") if actions and " ..." in text.split("\n\n")[0] else ():
            lines += [f"### hypernode {name} {action}", "", *_block(_help([*command, name, action]))]
    return "\n".join(lines)


def _help(words: Sequence[str]) -> str:
    done = subprocess.run(
        [*words, "--help"], capture_output=True, text=True, check=True, env={**os.environ, "COLUMNS": "100"}
    )
    return done.stdout.strip()


def _block(text: str) -> list[str]:
    return ["```text", text, "```", ""]
