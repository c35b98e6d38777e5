"""Numbers of frames, from the digits in the names of their files."""

import re
from collections import Counter
from pathlib import Path

from hypernode.dic.errors import DicError

#: Digits of a frame's number that DaVis and others write; what stands before them belongs to the name.
_DIGITS = 4
#: A load, a way, a strain or a time with decimals.
_DECIMAL = re.compile(r"(-?\d+[.,]\d+)(?= ?(?:[mk]?N|[mu\u00b5]m|%|m?s)(?![A-Za-z]))")
#: Largest number of a frame that a computer tells from the next one, whatever it is multiplied by.
_LARGEST = 10**15


def numbered(folder: Path, paths: list[Path]) -> dict[int, Path]:
    """Number -> file of a series: the digits that vary in the names, without what all of them have in front.

    Raises:
        DicError: names hold no number, a number is there twice, or digits vary in more than one place.
    """
    runs = [re.findall(r"\d+", path.name) for path in paths]
    if not runs[0]:
        return {0: paths[0]}
    usual = _place(runs)
    varying = len({run[usual] for run in runs}) > 1
    others = range(len(runs[0])) if varying else ()
    place = next((k for k in (usual, *others) if _goes_together(runs, k)), usual)
    digits = [run[place] for run in runs]
    others = Counter(tuple(run[:place] + run[place + 1 :]) for run in runs)
    width = len(digits[0])
    front = {each[:-_DIGITS] for each in digits if width > _DIGITS and len(each) == width}
    cut = width - _DIGITS if len(front) == 1 and all(len(each) == width for each in digits) else 0
    if (len(others) > 1 and not _goes_together(runs, place)) or _two_series(digits, width):
        if decimals := _by_decimals(paths):
            return decimals
        names = sorted({re.sub(r"\d+", "#", path.name) for path in paths} | {path.name for path in paths[:2]})
        raise DicError(f"{folder}: several series ({', '.join(names)}, ...): keep one a folder")
    files: dict[int, Path] = {}
    for path, each in zip(paths, digits, strict=True):
        number = int(each[cut:])
        if number > _LARGEST:
            raise DicError(f"{path}: {each} is too large a number for a frame: number the files from 1 on")
        if number in files:
            raise DicError(f"{path}: frame {number} is there twice ({files[number].name})")
        files[number] = path
    return dict(sorted(files.items()))


def _by_decimals(paths: list[Path]) -> dict[int, Path]:
    """Running number -> file, from 0 on, where names differ in one number with decimals and a unit; else nothing."""
    values = {path: _DECIMAL.findall(path.name) for path in paths}
    if len({_DECIMAL.sub("", name.name) for name in paths}) > 1 or any(len(found) != 1 for found in values.values()):
        return {}
    number = {path: float(found[0].replace(",", ".")) for path, found in values.items()}
    return dict(enumerate(sorted(paths, key=number.get))) if len(set(number.values())) == len(paths) else {}


def _goes_together(runs: list[list[str]], place: int) -> bool:
    """Whether a number of its own in each name grows with all other digits that vary: a time, a load, a counter.

    Of a load or a time with decimals, as 0.25 and 1.13, digits behind the sign grow with those before it only.
    """
    values = sorted(([int(each) for each in run] for run in runs), key=lambda run: run[place])
    own = [run[place] for run in values]
    if len(set(own)) < len(own):
        return False
    for k in (k for k in range(len(values[0])) if k != place):
        alone, before = _grows([run[k] for run in values]), k - 1 not in (-1, place)
        if not alone and not (before and _grows([run[k - 1 : k + 1] for run in values])):
            return False
    return True


def _grows(values: list) -> bool:
    return values == sorted(values)


def _two_series(digits: list[str], width: int) -> bool:
    """Whether numbers as 10001 and 20001 are those of test 1 and test 2."""
    fronts = Counter(each[:-_DIGITS] for each in digits)
    again = Counter(each[-_DIGITS:] for each in digits)
    return width > _DIGITS and len(fronts) > 1 and max(again.values()) > 1


def _place(runs: list[list[str]]) -> int:
    """Which of the runs of digits in the names is the frame's number."""
    counts = [len({run[k] for run in runs}) for k in range(len(runs[0]))]
    long = [k for k in range(len(counts)) if all(len(run[k]) >= _DIGITS for run in runs)]
    varying = [k for k, count in enumerate(counts) if count > 1]
    for choice in (
        [k for k in long if k in varying],
        [k for k in long if all(run[k].startswith("0") for run in runs)],
        varying,
        long,
    ):
        if choice:
            return choice[-1]
    return len(counts) - 1
