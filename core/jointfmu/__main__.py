"""`python -m jointfmu`: runs the installed command `jointfmu`, found by its entry point."""

import sys
from importlib.metadata import entry_points

(COMMAND_ENTRY_POINT,) = entry_points(group="console_scripts", name="jointfmu")
sys.exit(COMMAND_ENTRY_POINT.load()())
