"""python -m lensbench: the same as the command lensbench."""

import sys

from .cli import main

sys.exit(main())
