"""Windows without a screen: Qt draws into memory; stages are drawn off screen anyhow."""

import os

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
