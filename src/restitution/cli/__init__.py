"""The command line: one module for each verb (subcommand), and modules that the verbs share.

Large modules are imported inside the functions that use them, so that help texts appear quickly.
"""

import errno
import sys

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
    from restitution.cli.app import app
    from restitution.cli.console import print_error
    from restitution.cli.environment import prepare
    from restitution.cli.signals import Stopped, received, stoppable
    from restitution.errors import RestitutionError

    try:
        with stoppable():
            try:
                prepare(sys.argv[1:])
                app(prog_name="restitution")
            except BaseException:
                if received:
                    raise Stopped(received[-1]) from None
                raise
    except RestitutionError as error:
        print_error(str(error))
    except MemoryError:
        print_error("the memory is too small for this case; use fewer grid.nodes")
    except OSError as error:
        if error.filename is not None and error.errno in _OUTPUT_FAILS | _ACCESS_DENIED:
            print_error(
                f"{error.filename}: cannot be read or written ({error.strerror}); change its "
                "permissions, free disk space, or name another file or folder"
            )
            return 1
        if error.errno not in _OUTPUT_FAILS:
            raise
        print_error(f"standard output cannot be written ({error.strerror}); redirect it elsewhere")
        # Drop the stream. Otherwise Python would try to write its buffer at exit and fail again.
        sys.stdout = None
    except Stopped as stop:
        return stop.status
    return 1
