"""The command line: `verbs` with their options, and modules that do what the verbs say."""

import errno
import os
import sys
from collections.abc import Sequence

from restitution.errors import CaseError, RestitutionError, shown

# Error numbers of failed output: the disk or the quota is full, a file is too large, or a device
# fails.
_OUTPUT_FAILS = {errno.ENOSPC, errno.EFBIG, errno.EIO, getattr(errno, "EDQUOT", errno.ENOSPC)}

# Error numbers of a file or folder that the user may not access, or whose path is not valid.
_ACCESS_DENIED = {
    errno.EACCES,
    errno.EPERM,
    errno.EROFS,
    errno.ENOTDIR,
    errno.EISDIR,
    errno.ELOOP,
    errno.ENAMETOOLONG,
}

# Environment variables for the number of threads. The first variable that is set is used.
_THREADS = ("DUCC0_NUM_THREADS", "OMP_NUM_THREADS")


def main() -> None:
    """Run the command line. An error that the user can fix gives one red line and exit status 1."""
    try:
        for stream in (sys.stdout, sys.stderr):
            # A terminal whose encoding lacks Greek letters shows question marks instead.
            getattr(stream, "reconfigure", lambda **_: None)(errors="replace")
        sys.exit(_run())
    except KeyboardInterrupt:
        sys.exit(130)


def _run() -> int:
    from restitution.cli.signals import Stopped, received, stoppable

    try:
        with stoppable():
            try:
                prepare(sys.argv[1:])
                from restitution.cli.verbs import program

                program(prog_name="restitution")
            except BaseException:
                if received:
                    raise Stopped(received[-1]) from None
                raise
    except RestitutionError as error:
        _print_error(str(error))
    except MemoryError:
        _print_error("the memory is too small for this case; use fewer grid.nodes")
    except OSError as error:
        if error.filename is not None and error.errno in _OUTPUT_FAILS | _ACCESS_DENIED:
            _print_error(
                f"{error.filename}: cannot be read or written ({error.strerror}); change its "
                "permissions, free disk space, or name another file or folder"
            )
            return 1
        if error.errno not in _OUTPUT_FAILS:
            raise
        _print_error(f"standard output cannot be written ({error.strerror}); redirect it elsewhere")
        # Drop the stream. Otherwise Python would try to write its buffer at exit and fail again.
        sys.stdout = None
    except Stopped as stop:
        return stop.status
    return 1


def _print_error(message: str) -> None:
    from restitution.cli.console import print_error

    print_error(message)


def prepare(arguments: Sequence[str]) -> None:
    """Refuse a wrong number of threads, a removed folder, and paths that are not UTF-8."""
    # Select a matplotlib backend that writes files, because the environment may select an
    # interactive one.
    os.environ["MPLBACKEND"] = "agg"
    _check_threads()
    try:
        current = os.getcwd()
    except OSError:
        raise CaseError("the current folder was removed; change to another folder") from None
    for path in (*arguments, current):
        try:
            path.encode()
        except UnicodeEncodeError:
            raise CaseError(
                f"{shown(path, 200)}: the name is not UTF-8, but netCDF requires UTF-8; rename it"
            ) from None


def _check_threads() -> None:
    name = next((name for name in _THREADS if name in os.environ), _THREADS[0])
    text = os.environ.get(name, "")
    if not text.strip():
        os.environ.pop(name, None)
        return
    # OMP_NUM_THREADS may be a list of numbers, one for each level of nested parallelism. The first
    # number is for the outermost level.
    first = text.split(",")[0].strip() if name == "OMP_NUM_THREADS" else text.strip()
    if not (first.isascii() and first.isdigit() and len(first) < 10):
        raise CaseError(
            f"{name}: {shown(text)} is not a number of threads; set the variable to a whole number "
            "of at least 1, or unset it"
        )
    os.environ["DUCC0_NUM_THREADS"] = first
