"""`python -m gclip` runs `gclip`."""

from gclip.cli import main

raise SystemExit(main())
