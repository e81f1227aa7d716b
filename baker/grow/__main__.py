"""`python -m baker.grow`, the same as the command `grow`."""

import sys

from baker.grow.cli import main

if __name__ == "__main__":
    sys.exit(main())
