"""What the command line says of a specimen, and where files may be written."""

import argparse
from pathlib import Path

from hypernode.errors import ExpectedError

#: Options with one value -> key of the specimen.
_ONE_VALUE = {"pixel_size": "pixel_size", "frame_rate": "frame_rate", "load": "load", "force_file": "force_file"}
#: Keys that the command line does not take: the folder is its argument, and several tests take a file.
_OTHERWISE = {"folder": "it is the argument FOLDER", "tests": "several tests are written into a configuration"}


class UsageError(ExpectedError, ValueError):
    """The command line cannot be meant as it is written."""


def add_folder_options(parser: argparse.ArgumentParser) -> None:
    """The folder, and what may be said of its specimen."""
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder of displacement files and force record")
    parser.add_argument(
        "--size",
        type=float,
        nargs=3,
        metavar=("WIDTH", "HEIGHT", "THICKNESS"),
        help="of the sheet [mm]: along x, along y, and across",
    )
    parser.add_argument("--pixel-size", type=float, metavar="MM", help="length of a pixel on the sheet [mm]")
    parser.add_argument("--frame-rate", type=float, metavar="HZ", help="frames in a second, their numbers counted")
    parser.add_argument("--load", metavar="KIND", help="clamped_y, biaxial, ...; told from the frames if not")
    parser.add_argument("--force-file", metavar="NAME", help="force record; found by its content if not")
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="any key of a specimen, its value in YAML"
    )
    parser.add_argument(
        "--figure",
        type=Path,
        nargs="?",
        const=Path(),
        metavar="FILE",
        help="draw it into FILE.pdf or FILE.png; without FILE into both inspect_<folder>.pdf and .png here",
    )
    parser.add_argument("--json", action="store_true", help="for machines")


def given_settings(arguments) -> dict:
    """Keys of the specimen that the command line gives.

    Raises:
        UsageError: a key is given twice, or none of a specimen's that the command line takes.
    """
    given = {key: getattr(arguments, name) for name, key in _ONE_VALUE.items() if getattr(arguments, name) is not None}
    if arguments.size:
        given |= dict(zip(("width", "height", "thickness"), arguments.size, strict=True))
    for text in arguments.set:
        key, sign, value = text.partition("=")
        if not sign or not key:
            raise UsageError(f"--set {text}: write KEY=VALUE, such as --set edge_ring=2")
        if key in _OTHERWISE:
            raise UsageError(f"--set {text}: {_OTHERWISE[key]}")
        if key in given:
            raise UsageError(f"--set {text}: {key} is given twice")
        given[key] = _yaml(text, value)
    return given


def _yaml(text: str, value: str):
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    try:
        return YAML(typ="safe", pure=True).load(value)
    except YAMLError:
        raise UsageError(f"--set {text}: the value is not YAML") from None


def figure_files(arguments, name: str) -> list[Path]:
    """Files of the figure: none, the one that is named, or two in the working directory.

    Args:
        arguments: of the command line.
        name: of the specimen.

    Raises:
        UsageError: a format is not known, or the file lies in the folder that is looked at.
    """
    if arguments.figure is None:
        return []
    files = [arguments.figure]
    if arguments.figure == Path():
        files = [Path(f"inspect_{name}.{kind}") for kind in ("pdf", "png")]
    for file in files:
        if file.suffix.lower() not in (".pdf", ".png"):
            raise UsageError(f"--figure {file}: name a file that ends in .pdf or .png, and FOLDER before --figure")
        keep_out(arguments.folder, file)
    return files


def keep_out(folder: Path, file: Path) -> None:
    """Nothing, where a file that is to be written lies outside the measurement's folder.

    Raises:
        UsageError: it lies in the folder.
    """
    if file.resolve().is_relative_to(folder.resolve()):
        raise UsageError(
            f"{file}: lies in {folder}: measurements stay as they are; go to another folder, or name a file elsewhere"
        )
