"""`python -m baker` is `bake`."""

import sys

from baker.cli import main

sys.exit(main())
