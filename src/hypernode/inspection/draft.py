"""The smallest configuration that runs a folder, with what of it is a guess."""

import textwrap
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from hypernode.config.loading import ConfigError, load_config
from hypernode.config.model import Config
from hypernode.config.yaml_text import yaml_value
from hypernode.dic.errors import DicError
from hypernode.inspection.folder import Inspection

#: Columns of a line.
_WIDTH = 110
#: Place of a key among those of the specimen; others follow.
_ORDER = {key: k for k, key in enumerate(("width", "height", "thickness", "pixel_size", "frame_rate", "load"))}


def draft(seen: Inspection, method: str | None = None) -> str:
    """YAML of a configuration with the folder as its one specimen.

    Args:
        seen: the folder.
        method: with which it is identified, if not with the default.

    Raises:
        DicError: something is missing; the message is what.
    """
    if seen.sheet is None:
        raise DicError("\n".join(remark.sentence for remark in seen.known.missing))
    lines = ["# What a folder shows and what was said of it. Lengths in mm, times in s, forces in N."]
    lines += ["specimens:", f"  {yaml_value(seen.name)}:", f"    folder: {yaml_value(str(seen.folder))}"]
    for key, value in sorted(seen.known.settings.items(), key=lambda item: _ORDER.get(item[0], len(_ORDER))):
        if key in seen.known.guesses:
            text = textwrap.wrap(f"A guess: {seen.known.guesses[key]}", _WIDTH, break_on_hyphens=False)
            lines += [f"    # {line}" for line in text]
        lines.append(f"    {key}: {yaml_value(value)}")
    if method is not None:
        lines += [
            "cases:",
            f"  {yaml_value(seen.name)}: {{specimen: {yaml_value(seen.name)}, methods: [{yaml_value(method)}]}}",
        ]
    return "\n".join(lines) + "\n"


def write_draft(seen: Inspection, file: Path, method: str | None = None, over: Sequence[Path] = ()) -> Config:
    """Write the configuration, once it is known to load.

    Args:
        seen: the folder.
        file: where to. One that says something else already is not written over.
        method: with which it is identified, if not with the default.
        over: further configurations, which are laid over it.

    Returns:
        The configuration, with what is laid over it.

    Raises:
        DicError: something is missing, or the file has another content.
        ConfigError: the configuration cannot be used.
    """
    text = draft(seen, method)
    if file.exists() and file.read_text(encoding="utf-8") != text:
        raise DicError(
            f"{file}: is there already and says something else: use it as it is, snakemake --configfile {file}, delete "
            "it, or name another, --write-config FILE"
        )
    with TemporaryDirectory() as folder:
        trial = Path(folder) / file.name
        trial.write_text(text, encoding="utf-8")
        try:
            config = load_config(trial, *over)
        except ConfigError as error:
            raise ConfigError(str(error).replace(str(trial), str(file))) from None
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")
    return config
