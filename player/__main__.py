"""`python -m player` is `play`."""

from player.cli import main

raise SystemExit(main())
