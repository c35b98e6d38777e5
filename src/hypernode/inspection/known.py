"""What is known of a specimen, what of it is a guess, and what is missing or odd."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from hypernode.config.specimens import Specimen

#: Sides of a sheet [mm] as long as nobody has said them: files are read without.
ANY_SIZE = {"width": 1.0, "height": 1.0, "thickness": 1.0}


@dataclass(frozen=True)
class Remark:
    """A sentence, and the key of the specimen that answers it, where there is one."""

    sentence: str
    key: str | None = None


@dataclass(frozen=True)
class Known:
    """What is known; sums of it are known together.

    Attributes:
        settings: keys of the specimen, given or guessed.
        guesses: key -> why it was guessed.
        missing: what must be given, or is refused.
        odd: what is strange.
    """

    settings: Mapping[str, object] = field(default_factory=dict)
    guesses: Mapping[str, str] = field(default_factory=dict)
    missing: tuple[Remark, ...] = ()
    odd: tuple[Remark, ...] = ()

    def __add__(self, other: "Known") -> "Known":
        return Known(
            {**self.settings, **other.settings},
            {**self.guesses, **other.guesses},
            self.missing + other.missing,
            self.odd + other.odd,
        )

    @property
    def sized(self) -> bool:
        """Whether width, height and thickness are known."""
        return ANY_SIZE.keys() <= self.settings.keys()

    def specimen(self, folder: Path) -> Specimen:
        """The specimen with what is known, of 1 mm where its size is not."""
        return Specimen.model_validate({**ANY_SIZE, **self.settings, "folder": str(folder)})


def guessed(key: str, value: object, why: str) -> Known:
    """One key that is guessed."""
    return Known({key: value}, {key: why})


def missing(sentence: str, key: str | None = None) -> Known:
    """One thing that must be given, or is refused."""
    return Known(missing=(Remark(sentence, key),))


def odd(sentence: str, key: str | None = None) -> Known:
    """One thing that is strange."""
    return Known(odd=(Remark(sentence, key),))
