"""``hypernode challenge FILE.npz``: the material of every point of a test of the 2025 Mechanical MNIST Challenge."""

import json
from pathlib import Path

from hypernode.commands.options import UsageError


def add_challenge(commands) -> None:
    """``challenge FILE [FILE ...]``."""
    parser = commands.add_parser(
        "challenge", help="label every point of tests of the 2025 Mechanical MNIST Challenge; scores those with labels"
    )
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE", help="tests, as .npz")
    parser.add_argument("--classes", type=Path, metavar="JSON", help="stiffnesses of the materials, from --learn")
    parser.add_argument(
        "--learn", type=Path, metavar="JSON", help="write the stiffnesses of the materials of labelled tests"
    )
    parser.add_argument(
        "--output", type=Path, metavar="FILE", help="where predicted_label is written (FILE_predicted.npz here)"
    )
    parser.set_defaults(run=run_challenge)


def run_challenge(arguments) -> int:
    """Label tests, write ``predicted_label`` of each, and print scores.

    Raises:
        UsageError: options that contradict each other.
        ChallengeError: a file is no test of the challenge.
    """
    if arguments.output and len(arguments.files) > 1:
        raise UsageError(f"--output {arguments.output}: names one file, and {len(arguments.files)} tests are given")
    if arguments.learn and arguments.learn.exists():
        raise UsageError(f"--learn {arguments.learn}: is there already; name another file, or delete it")
    from hypernode.pipeline.compiler import set_up_compiler

    set_up_compiler(float64=True)
    import numpy as np

    from hypernode.challenge.classes import mean_pairs, pair_of_label
    from hypernode.stages.challenge import run

    pairs, scores, learned = _classes(arguments.classes), [], []
    for file in arguments.files:
        found = run(file, pairs)
        output = arguments.output or Path(f"{file.stem}_predicted.npz")
        np.savez(output, predicted_label=found.predicted_label)
        print(
            f"{file}: {_said(found)}\n" + "".join(f"  note: {each}\n" for each in found.remarks) + f"written   {output}"
        )
        scores += [] if found.score is None else [found.score]
        if arguments.learn:
            if found.test.label is None:
                raise UsageError(f"{file}: has no label, from which --learn takes which material is which")
            learned.append(pair_of_label(found.test.label, found.stiffer, found.stress, str(file)))
    if len(scores) > 1:
        print(f"mean score of {len(scores)} tests: {np.mean(scores):.3f}")
    if arguments.learn:
        arguments.learn.write_text(json.dumps({"pairs": [p.stored() for p in mean_pairs(learned)]}, indent=1) + "\n")
        print(f"written   {arguments.learn}")
    return 0


def _classes(path: Path | None):
    """Pairs of materials of a file that --learn wrote."""
    from hypernode.challenge.classes import PairOfMaterials

    if path is None:
        return []
    try:
        return [PairOfMaterials(**each) for each in json.loads(path.read_text())["pairs"]]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise UsageError(f"--classes {path}: is no file that --learn writes: {error}") from None


def _said(found) -> str:
    """What was found, in a line."""
    soft, stiff = found.stress
    share = found.stiffer.mean()
    names = f"classes {found.pair.soft} and {found.pair.stiff}" if found.pair else "classes not known (--classes): 0, 1"
    score = ""
    if found.score is not None:
        score = f"; score {found.score:.3f}" + ("" if found.pair else " of the shape alone")
    return f"{names}; {100.0 * share:.0f} % stiffer, by {stiff / soft:.2f}{score}"
