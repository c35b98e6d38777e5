"""Columns of positions and displacements in the words that people use, with units as they write them."""

import re
from collections.abc import Sequence
from dataclasses import replace

from hypernode.dic.dialect import Dialect
from hypernode.dic.dialects import BY_NAME
from hypernode.dic.header import LENGTHS, cells_of

#: Lines in which such a header is looked for.
_LINES = 60
#: Ways in which a unit stands behind a name: in brackets, or after a sign.
_UNIT = re.compile(
    r"^(?P<name>.*?)(?:\s*[\[(](?P<in>[^\[\]()]*)[\])]|\s*(?:[_,/]|\s|\bin\b)\s*(?P<after>mm|px|pixels?|um|µm|cm))$",
    re.IGNORECASE,
)
_POSITIONS = ("pos", "position", "coord", "coordinate", "koordinate", "coordonnée", "coordonnee", "location")
_POSITIONS += ("coordenada", "posición", "posicion", "coordinata", "posizione", "posição", "posicao", "coördinaat")
_POSITIONS += (
    "koordinat",
    "koordinaatti",
    "posisjon",
    "coordinaat",
    "positie",
    "współrzędna",
    "координата",
    "坐标",
    "座標",
)
_AT_REST = ("ref", "reference", "undeformed", "undef", "initial", "init")
_BOTH_WAYS = tuple(each for word in (*_POSITIONS, *_AT_REST) for each in (f"{{}}{word}", f"{word}{{}}"))
_PLACES = ("{}", "{}0", *_BOTH_WAYS, "points{}", "point{}")
_MOVED = ("deformed", "def", "current", "cur", "final", "verformt", "déformé", "deformada", "deformata")
_MOVED_PLACES = tuple(each for word in _MOVED for each in (f"{{}}{word}", f"{word}{{}}"))
#: Positions in the deformed sheet, in the place of displacements.
_ENDS = (*_MOVED_PLACES, "{}1")
_WORDS = ("displacement", "disp", "verschiebung", "verformung", "déplacement", "deplacement", "depl", "dépl")
_WORDS += ("desplazamiento", "spostamento", "deslocamento", "verplaatsing", "przemieszczenie", "位移", "変位")
_WORDS += ("förskjutning", "forskydning", "forskyvning", "siirtymä")
#: What stands between a word for a displacement and its axis.
_BETWEEN = {"in", "along", "direction", "dir", "component", "nach", "entlang", "richtung", "komponente", "en", "selon"}
_BETWEEN |= {"suivant", "sens", "dirección", "direccion", "lungo", "direzione", "componente", "composante", "i"}
_MOVES = ("{0}", "{0}{1}", "u{1}", "d{1}", *(f"{{1}}{word}" for word in _WORDS), *(f"{word}{{1}}" for word in _WORDS))
_MOVES += (*(f"{word}{{0}}" for word in _WORDS), *(f"{{0}}{word}" for word in _WORDS))
#: Words that stand for an axis.
_AXES = {
    "x": re.compile(r"hori[sz]ontal(?:e[rns]?)?|orizzontale|horizontaal|poziom[ay]"),
    "y": re.compile(r"verti[ck]al(?:e[rns]?)?|verticaal|pionow[ay]"),
}
#: Columns with the number of a frame, of tables that hold all of them.
_FRAMES = ("frame", "framenumber", "frameno", "frameid", "frameindex", "image", "imagenumber", "imageno", "imageindex")
_FRAMES += ("picture", "bild", "bildnummer", "bildnr", "step", "loadstep", "timestep", "stepnumber", "increment", "inc")
_FRAMES += ("stage", "stufe", "laststufe")
_SIGNS = (",", ";", "\t", " ")


def named_table(lines: Sequence[str]) -> Dialect | None:
    """The dialect of a table whose header names positions and displacements; None where there is no such header.

    Args:
        lines: of the beginning of a file.
    """
    for line in lines[:_LINES]:
        # Names may have blanks where another sign stands between them.
        signs = [sign for sign in _SIGNS[:-1] if line.count(sign) >= len("xyuv") - 1]
        for sign in signs or _SIGNS:
            names = cells_of(line.lstrip("# "), sign)
            if len(names) >= len("xyuv") and (found := _dialect(names, sign)):
                return found
    return None


def _dialect(names: list[str], sign: str) -> Dialect | None:
    split = [_name_and_unit(name) for name in names]
    plain = [_plain(name) for name, _ in split]
    columns = {role: _column(plain, role, _PLACES, ()) for role in "xy"} | _moved(plain)
    deformed = False
    ends = {role: _column(plain, axis, _ENDS, ()) for role, axis in zip("uv", "xy", strict=True)}
    if None in ends.values() and columns["u"] is columns["v"] is None:
        # X0 beside X is where a point was, and X where it came to.
        rest = {role: _column(plain, role, ("{}0",), ()) for role in "xy"}
        if None not in rest.values():
            columns |= rest
            ends = {role: _column(plain, axis, ("{}",), ()) for role, axis in zip("uv", "xy", strict=True)}
    positions = columns["u"] is columns["v"] is None not in ends.values()
    columns |= ends if positions else {}
    if columns["x"] is None and columns["y"] is None:
        columns |= {role: _column(plain, role, _MOVED_PLACES, ()) for role in "xy"}
        deformed = True
    if None in columns.values() or len(set(columns.values())) < len(columns):
        return None
    stereo = {"z": _column(plain, "z", _PLACES, _MOVES), "w": _column(plain, "w", _PLACES, _MOVES)}
    columns |= {} if None in stereo.values() else stereo
    frames = [k for k, name in enumerate(plain) if name in _FRAMES and k not in columns.values()]
    units = sorted({split[k][1] for k in columns.values()} - {""})
    decimals = (".",) if sign in (",", " ") else (".", ",")
    return replace(
        BY_NAME["table"],
        recognised=tuple(names[columns[role]] for role in "xyuv"),
        **{role: (names[k],) for role, k in columns.items()},
        unit=" and ".join(units) or None,
        layouts=tuple((sign, decimal) for decimal in decimals),
        deformed=deformed,
        positions=positions,
        frame=split[frames[0]][0] if len(frames) == 1 else None,
        lost_position=not deformed,
    )


def _plain(name: str) -> str:
    """A name in small letters without blanks, and a letter for an axis."""
    words = re.split(r"[\s_.\-]+", name.lower())
    if any(word in each for word in _WORDS for each in words):
        words = [each for each in words if each not in _BETWEEN]
    name = "".join(words)
    for axis, words in _AXES.items():
        name = words.sub(axis, name)
    return name


def _moved(plain: list[str]) -> dict[str, int | None]:
    """Indices of u and v: of the first words that both have, since u beside ux and uy is how far a point has moved."""
    alike = [{role: _column(plain, role, (), (word,)) for role in "uv"} for word in _MOVES]
    mixed = {role: _column(plain, role, (), _MOVES) for role in "uv"}
    return next((each for each in alike if None not in each.values()), mixed)


def _name_and_unit(name: str) -> tuple[str, str]:
    """A column's name and its unit, empty where it has none that is known."""
    match = _UNIT.match(name.strip())
    unit = ((match["in"] or match["after"] or "") if match else "").strip()
    known = unit.lower() in LENGTHS or (match and match["in"] is not None)
    return (match["name"], unit) if match and known else (name, "")


def _column(plain: list[str], role: str, places: tuple[str, ...], moves: tuple[str, ...]) -> int | None:
    """Index of the one column of a role: the first word that any has; None where none or several have it."""
    axis = {"u": "x", "v": "y", "w": "z"}.get(role, role)
    words = [each.format(role) for each in places] if role in "xyz" else [each.format(role, axis) for each in moves]
    for word in words:
        if word in plain:
            return plain.index(word) if plain.count(word) == 1 else None
    return None
