"""`python -m grow` runs `grow`."""

from grow.cli import main

if __name__ == "__main__":
    raise SystemExit(main())
