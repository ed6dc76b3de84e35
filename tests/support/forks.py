"""Runs of a program by a server that forks (fork_server.cpp), in a tenth of the time of a start."""
import os
import socket
import struct
import subprocess
import threading

_of_thread = threading.local()


class Forks:
    def __init__(self, program, library):
        self.socket, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with other:
            self.server = subprocess.Popen(
                [program], pass_fds=[other.fileno()],
                env={**os.environ, "LD_PRELOAD": library, "SUPPLE_FORKS": str(other.fileno())})

    def start(self, arguments, cwd, streams):
        """The process number of the run."""
        strings = [os.fspath(cwd or os.getcwd()), str(len(arguments)), *arguments,
                   *("%s=%s" % entry for entry in os.environ.items())]
        text = b"".join(os.fsencode(string) + b"\0" for string in strings)
        socket.send_fds(self.socket, [text], [stream.fileno() for stream in streams])
        return struct.unpack("q", self.socket.recv(8))[0]

    def wait(self):
        """Its status, and its peak memory in KiB."""
        return struct.unpack("qq", self.socket.recv(16))


def forks(program):
    """The server of this thread; None where the tests are run without."""
    library = os.environ.get("SUPPLE_FORK_SERVER")
    if library and not hasattr(_of_thread, "forks"):
        _of_thread.forks = Forks(program, library)
    return _of_thread.forks if library else None
