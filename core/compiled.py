"""Compiled loops: functions of Python that numba turns into machine code, kept on the disk for the next start.

`compiled` is for functions that Python calls, `inlined` for those that only compiled functions call.
What a compiled function answers must not depend on what was compiled or loaded before it, so

- every option is stated: what is not (`fastmath`) a function would inherit from whichever caller compiles it first;
- what a compiled function calls becomes part of it: a copy of its own could be replaced by that of another function;
- the processor's instructions are pinned to what all processors of ten years have, not those of this one.

Saved code lies in one folder, named after a hash over all files with compiled functions and those they take numbers
from, the libraries' versions and the processor: code of yesterday's files is never found. Where a package brings saved
code along, it is used from there.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import pickle
import re
import secrets
import shutil
import sys
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, cast

from llvmlite import binding

from core import sources
from core.code_cache import code_cache, temporary_cache, usual_cache
from core.held_files import rename
from core.processor import PROCESSOR
from core.sources import PACKAGE, SHIPPED

if TYPE_CHECKING:
    from numba.core.dispatcher import Dispatcher

Function = TypeVar("Function", bound=Callable[..., object])

_IMPORT = b"from core.compiled import"
"""What a file with compiled functions says."""
_IMPORTED = re.compile(rb"^from (core[\w.]*) import", re.MULTILINE)
_SWEPT_AFTER_S = 14 * 24 * 3600.0
"""Saved code of other versions is removed once it has not been used for so long, in s."""

os.environ["NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING"] = "1"  # it colours what it only tries: a twentieth of the time

import numba  # noqa: E402 - reads the line above, and those of `core.processor`
from numba.core import types  # noqa: E402
from numba.core.compiler import CompileResult  # noqa: E402
from numba.core.serialize import dumps  # noqa: E402

numba.core.config.reload_config()  # type: ignore[no-untyped-call]  # should it have been imported before


def compiled(*, fastmath: bool | set[str] = False, inline: bool = False) -> Callable[[Function], Dispatcher[Function]]:
    """Declare a function that is compiled, runs without Python's lock, and divides by zero as numpy does.

    With `fastmath` sums may be reordered, or only what a set of LLVM's flags allows. With `inline` it becomes part of
    the compiled functions that call it, and Python can call it too.
    """
    return _declared(fastmath, forceinline=inline)


def inlined(*, fastmath: bool | set[str] = False) -> Callable[[Function], Dispatcher[Function]]:
    """Declare a compiled function to be inlined in the compiled functions that call it; Python cannot call it."""
    return _declared(fastmath, forceinline=True, no_cpython_wrapper=True)


def _declared(fastmath: bool | set[str], **options: bool) -> Callable[[Function], Dispatcher[Function]]:
    def declare(function: Function) -> Dispatcher[Function]:
        chosen: dict[str, Any] = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True, **options}
        dispatcher: Dispatcher[Function] = numba.njit(fastmath=fastmath, **chosen)(function)
        adapted = cast(Any, dispatcher)
        adapted._cache = _Saved(function)
        adapted.get_call_template = _with_plain_types(adapted.get_call_template)
        if "no_cpython_wrapper" in options:  # nothing there that Python could call: it would end the process
            adapted._insert = lambda *_, **__: None
            adapted._compile_for_args = _refuse
        return dispatcher

    return declare


def _with_plain_types(template: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    """How numba finds the code for types of arguments, with one code for all whole numbers that a caller spells out."""
    plain = cast(Any, types.unliteral)
    return lambda args, kws: template(tuple(map(plain, args)), {name: plain(kind) for name, kind in kws.items()})


def _refuse(*_: object, **__: object) -> None:
    raise TypeError("only compiled functions can call an inlined one")


def _files(package: Path) -> dict[Path, bytes]:
    """The files with compiled functions, those they take numbers from, and this one, as they are now.

    Empty in a frozen program.
    """
    texts = sources.texts(package)
    own = [file for file, text in texts.items() if _IMPORT in text]
    modules = {name.decode() for file in own for name in _IMPORTED.findall(texts[file])}
    known = {package.parent.joinpath(*module.split(".")) for module in modules}
    return {file: text for file, text in texts.items() if file in own or file.with_suffix("") in known}


def _key(files: dict[Path, bytes]) -> str:
    """One number over what the files say, what makes the code and what it is made for.

    Raises InputError where there are no files and nothing is known of them: no code would ever be of other files.
    """
    says = sorted((sources.hashes(files) or sources.compiled_hashes()).items())
    made_by = (sys.implementation.cache_tag, *(version(name) for name in ("numba", "llvmlite", "numpy")))
    made_for = (binding.get_process_triple(), PROCESSOR)
    return hashlib.sha256(repr((says, made_by, made_for)).encode()).hexdigest()[:16]


def _folder(name: str) -> Path:
    """The folder of saved code of this name, made if need be; a temporary one where none can be written."""
    folder = code_cache() / name
    try:
        is_new = not folder.exists()
        folder.mkdir(exist_ok=True)  # another process may have made it meanwhile
        os.utime(folder)
        if is_new:
            _sweep(folder.parent)
        writable = os.access(folder, os.W_OK | os.X_OK)
    except OSError:
        writable = False
    if not writable:
        folder = temporary_cache() / name
        folder.mkdir(exist_ok=True)
    return folder


def _sweep(base: Path) -> None:
    """Remove the saved code that has not been used for long."""
    for old in base.iterdir():
        with contextlib.suppress(FileNotFoundError):  # another process sweeps, too
            if time.time() - old.stat().st_mtime > _SWEPT_AFTER_S:
                shutil.rmtree(old, ignore_errors=True)


_FILES = _files(PACKAGE)
FOLDER = _folder(_key(_FILES))
"""Where this version's saved code is put."""
_USUAL = usual_cache() / FOLDER.name


def _places() -> tuple[Path, ...]:
    """The folders that saved code is looked for in: a cache that can only be read serves as well."""
    return FOLDER, _USUAL, SHIPPED / FOLDER.name


class _Saved:
    """The saved code of one function, as numba's dispatchers ask for it.

    One file for each combination of types: numba's own index of them can be garbled by two processes that save at once.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self._name = f"{function.__module__}.{function.__qualname__}"

    def _file(self, signature: object) -> str:
        return f"{self._name}-{hashlib.sha256(repr(signature).encode()).hexdigest()[:16]}"

    def load_overload(self, signature: object, target_context: Any) -> Any:
        """The code for these types; None where it was not saved, or not whole."""
        target_context.refresh()
        for folder in _places():
            try:
                saved = (folder / self._file(signature)).read_bytes()
            except OSError:
                continue
            if hashlib.sha256(saved[32:]).digest() == saved[:32]:
                return CompileResult._rebuild(target_context, *pickle.loads(saved[32:]))  # type: ignore[no-untyped-call]
        return None

    def save_overload(self, signature: object, code: Any) -> None:
        """Keep the code, unless a file has changed since this process read it, or nothing can be written."""
        if code.library.has_dynamic_globals:
            raise TypeError(f"{self._name} holds an array or address of this process and cannot be saved")
        if any(file.read_bytes() != text for file, text in _FILES.items()):
            return
        content: bytes = dumps(code._reduce())  # type: ignore[no-untyped-call]
        beside = FOLDER / f"{self._file(signature)}.{secrets.token_hex(4)}.part"
        try:
            beside.write_bytes(hashlib.sha256(content).digest() + content)
            rename(beside, FOLDER / self._file(signature))
        except OSError:  # a full disk; or another process reads the same, which it has saved
            with contextlib.suppress(OSError):
                beside.unlink()


_COMPLETE = "complete"
"""A file of this name says that all a measurement needs was saved."""


def is_complete() -> bool:
    """Whether it is recorded that all compiled code a measurement needs is saved, here or with the package."""
    return any((folder / _COMPLETE).exists() for folder in _places())


def keep_complete() -> None:
    """Record that all compiled code is saved; does nothing where that cannot be written."""
    with contextlib.suppress(OSError):
        (FOLDER / _COMPLETE).touch()


def saved_functions() -> int:
    """Count the files of compiled code in this version's folder: one for each function and types of its arguments."""
    return sum(1 for _ in FOLDER.iterdir())
