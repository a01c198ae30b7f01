"""dynamic_reconfigure's server and the lab's configurations, imported without a search for packages."""

from . import lean_imports

lean_imports.skip_manifests()

from dynamic_reconfigure.server import Server as Server  # noqa: E402

from aro_robocop_goto_as.cfg import GotoConfig as GotoConfig  # noqa: E402
from aro_robocop_goto_as.cfg import SimConfig as SimConfig  # noqa: E402
