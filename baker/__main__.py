"""`python -m baker` runs `bake`."""

import sys

from baker.cli import main

sys.exit(main())
