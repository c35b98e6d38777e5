"""``python -m hypernode`` is the command ``hypernode``."""

import sys

from hypernode.cli import main

if __name__ == "__main__":
    sys.exit(main())
