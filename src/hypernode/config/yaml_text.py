"""Values of configurations that the project writes, as YAML of every version reads them."""

import json
import re

#: Text that needs no quotation marks, but for words that mean something else.
_PLAIN = re.compile(r"^[A-Za-z/][A-Za-z0-9_./-]*$")
_WORDS = {"null", "true", "false", "yes", "no", "on", "off", "y", "n"}


def yaml_value(value: object) -> str:
    """A value on one line: YAML, of which JSON is a part, without quotation marks and digits that say nothing.

    Numbers keep every bit, with a point in their mantissa: 1e-06 would be a text to some readers.
    """
    if isinstance(value, str) and _PLAIN.match(value) and value.lower() not in _WORDS:
        return value
    if isinstance(value, float) and value.is_integer() and abs(value) < 2**53:
        return str(int(value))
    if isinstance(value, float):
        mantissa, e, exponent = repr(value).partition("e")
        return mantissa + (".0" if "." not in mantissa else "") + e + exponent
    return json.dumps(value, ensure_ascii=False)
