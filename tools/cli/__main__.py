"""`python -m jointfmu_tools.cli`: the command `jointfmu`."""

import sys

from . import main

sys.exit(main())
