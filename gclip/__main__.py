"""`python -m gclip` runs `gclip`."""

import sys

from gclip.cli import main

sys.exit(main())
