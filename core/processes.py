"""How the program starts its own modules in another process, from source or frozen into one folder.

Python runs a module that it is given by name. A frozen program is no Python: what starts it (`bundle/`) lets
`run_asked_module` answer the same question before it reads any argument.
"""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

MODULE = "--module"
"""First argument of a frozen program that is to run one module: its name, or a file NAME.py, and arguments follow.

With a file it takes the place of the Python that such a program does not bring: scripts that import `core` run so.
"""


def is_frozen() -> bool:
    """Whether the program was frozen: it runs from a folder that contains its own Python."""
    return bool(getattr(sys, "frozen", False))


def module_command(module: str, *arguments: str) -> tuple[str, ...]:
    """Make the command line that runs a module of the program, as `__main__`, in another process."""
    if is_frozen():
        return (sys.executable, MODULE, module, *arguments)
    # -P: a module that lies in the current folder by chance is not taken for one of Python's
    return (sys.executable, "-P", "-m", module, *arguments)


def program_command(name: str, module: str) -> tuple[str, ...]:
    """Make the command line of the installed program `name`, or that runs `module` where there is none."""
    program = Path(sys.executable).with_name(name + (".exe" if sys.platform == "win32" else ""))
    return (str(program),) if program.exists() else module_command(module)


def run_asked_module() -> bool:
    """Run the module that the command line of a frozen program names; returns whether it named one."""
    if sys.argv[1:2] != [MODULE] or len(sys.argv) < 3:
        return False
    sys.argv = sys.argv[2:]
    if sys.argv[0].endswith(".py"):
        runpy.run_path(sys.argv[0], run_name="__main__")
    else:
        runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
    return True
