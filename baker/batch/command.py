"""The work of the command `bake`: a list of what would be baked, one plant or many."""

from collections.abc import Sequence
from contextlib import ExitStack, suppress
from functools import partial
from pathlib import Path
from shutil import rmtree

from baker.batch.bake_all import bake_all
from baker.batch.cache import Cache
from baker.batch.cluster import interval_solver
from baker.batch.listing import finding_lines, list_plants
from baker.batch.outputs import Outputs, check_apart, check_output
from baker.batch.plant import bake_into, with_corrections
