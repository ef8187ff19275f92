"""The command line: one verb a file, heavy imports inside the verb."""

import errno
import sys

# Reasons of the system why a terminal, pipe or file takes no more output.
_NO_ROOM = {errno.ENOSPC, errno.EFBIG, errno.EIO, getattr(errno, "EDQUOT", errno.ENOSPC)}

# Its reasons why a file or folder cannot be used.
_NO_ACCESS = {
    errno.EACCES,
    errno.EPERM,
    errno.EROFS,
    errno.ENOTDIR,
    errno.EISDIR,
    errno.ELOOP,
    errno.ENAMETOOLONG,
}


def main() -> None:
    """Run the command line; a user's error is one red line and status 1."""
    try:
        for stream in (sys.stdout, sys.stderr):
            # A terminal without Greek letters shows a question mark instead.
            getattr(stream, "reconfigure", lambda **_: None)(errors="replace")
        sys.exit(_run())
    except KeyboardInterrupt:
        sys.exit(130)


def _run() -> int:
    from restitution.cli.app import app
    from restitution.cli.console import print_error
    from restitution.cli.environment import prepare
    from restitution.cli.signals import Stopped, received, stoppable
    from restitution.errors import RestitutionError

    try:
        with stoppable():
            try:
                prepare(sys.argv[1:])
                app()
            except BaseException:
                if received:
                    raise Stopped(received[-1]) from None
                raise
    except RestitutionError as error:
        print_error(str(error))
    except MemoryError:
        print_error("the memory is too small for this case; use fewer grid.nodes")
    except OSError as error:
        if error.filename is not None and error.errno in _NO_ROOM | _NO_ACCESS:
            print_error(
                f"{error.filename}: cannot be read or written ({error.strerror}); change its "
                "permissions, make room, or name another"
            )
            return 1
        if error.errno not in _NO_ROOM:
            raise
        print_error(f"standard output: cannot be written ({error.strerror}); send it elsewhere")
        # What is left in its buffer would fail again when Python ends.
        sys.stdout = None
    except Stopped as stop:
        return stop.status
    return 1
