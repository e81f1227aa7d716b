"""Let the tests beside this file import the clouds that they share (import mode: importlib)."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
