"""`python -m baker` runs `bake`."""

from baker.cli import main

raise SystemExit(main())
