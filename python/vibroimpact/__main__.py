"""``python -m vibroimpact`` is the command ``vibro``."""

import sys

from ._command import main

sys.exit(main())
