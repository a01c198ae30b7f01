"""Usage: python agent CHANNEL SCRIPT [ARGUMENT...].

CHANNEL: a descriptor and the time on /clock [ns], with a comma.
"""

import ctypes
import importlib.util
import os
import sys
import types
from pathlib import Path
from typing import Any

PACKAGE = "robocop_agent"
FILE_INPUT, CLOSES = 257, 1  # Py_file_input; whether the file is closed


def load() -> Any:
    """This folder as a package with a name of its own: nothing else of the grader's comes into the node's path."""
    folder = Path(__file__).resolve().parent
    spec = importlib.util.spec_from_file_location(
        PACKAGE, folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    assert spec is not None and spec.loader is not None
    module = sys.modules[PACKAGE] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def run(script: str) -> None:
    """Run the script as the main module, read as python3 reads it: by compile() it would take other sources, too."""
    module: Any = types.ModuleType("__main__")
    module.__file__, module.__cached__, module.__builtins__ = script, None, __builtins__
    sys.modules["__main__"] = module
    sys.path[0] = os.path.dirname(os.path.realpath(script))
    c_library, python, name = ctypes.CDLL(None, use_errno=True), ctypes.pythonapi, os.fsencode(script)
    c_library.fopen.restype = ctypes.c_void_p
    # https://docs.python.org/3/c-api/veryhigh.html
    python.PyRun_FileExFlags.restype = ctypes.py_object
    file = ctypes.c_void_p(c_library.fopen(name, b"rb"))
    if not file:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()), script)
    names = ctypes.py_object(module.__dict__)
    python.PyRun_FileExFlags(file, name, FILE_INPUT, names, names, CLOSES, None)


def main() -> None:
    """Take over this process's time, then become the script."""
    descriptor, clock_ns = map(int, sys.argv[1].split(","))
    os.set_inheritable(descriptor, False)
    del sys.path[0]
    load().install(descriptor, clock_ns)
    sys.path.insert(0, "")
    script, sys.argv = sys.argv[2], sys.argv[2:]
    try:
        run(script)
    except Exception as error:
        trace = error.__traceback__
        for _ in range(2):  # main() and run()
            trace = trace and trace.tb_next
        sys.excepthook(type(error), error.with_traceback(trace), trace)
        status = 1
    else:
        status = 0
    sys.exit(status)


if __name__ == "__main__":
    main()
