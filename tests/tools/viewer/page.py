"""A page without a browser: starts `supple view`, speaks its protocol (tools/viewer/README.md), and
reads what comes. The standard library alone."""
import base64
import json
import os
import re
import select
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

VIEWS = ("3d", "axial", "coronal", "sagittal")
# Events that change pictures.
DRAWN = ("drag", "camera", "look", "clip", "undo", "redo", "relax", "cut", "material")
# Journals of the sessions of this process.
STATE = tempfile.TemporaryDirectory(prefix="supple-state-")
TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10


def binary():
    path = os.environ.get("SUPPLE_BINARY", "")
    if not os.access(path, os.X_OK):
        sys.exit("SUPPLE_BINARY names no program: run the tests through ctest")
    return path


def write_ball(path, size=40, radius=15):
    """A ball of 1000 in 0 with a bright core, as NRRD; and a material for it."""
    middle = (size - 1) / 2
    values = bytearray()
    for k in range(size):
        for j in range(size):
            for i in range(size):
                r2 = (i - middle) ** 2 + (j - middle) ** 2 + (k - middle) ** 2
                value = 0 if r2 > radius * radius else 1000 if r2 > 16 else 1200
                values += struct.pack("<h", value)
    head = ("NRRD0004\ntype: int16\ndimension: 3\nspace: left-posterior-superior\n"
            f"sizes: {size} {size} {size}\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
            "space origin: (0,0,0)\nendian: little\nencoding: raw\n\n")
    with open(path, "wb") as file:
        file.write(head.encode() + bytes(values))


class Server:
    """`supple view` on a free port."""

    def __init__(self, *arguments, folder=None, state=None, before=None):
        environment = {**os.environ, "XDG_STATE_HOME": state or STATE.name}
        self.process = subprocess.Popen(
            [binary(), "view", *arguments, "--no-browser", "--json"], cwd=folder, env=environment,
            preexec_fn=before,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError("no address: " + self.process.stderr.read())
        told = json.loads(line)
        self.port = told["port"]
        self.token = told["address"].split("#")[1]

    def stop(self, how=signal.SIGINT):
        if self.process.poll() is None:
            self.process.send_signal(how)
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        self.process.stdout.close()
        errors = self.process.stderr.read()
        self.process.stderr.close()
        return self.process.returncode, errors

    def memory_mb(self):
        with open(f"/proc/{self.process.pid}/status") as status:
            return int(re.search(r"VmRSS:\s+(\d+)", status.read())[1]) / 1000

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.stop()


class Frame:
    def __init__(self, data):
        magic, self.event, self.number, view, png, settled, _, self.width, self.height, self.ms = (
            struct.unpack("<4sIIBBBBHHf", data[:24]))
        assert magic == b"SVF1", magic
        self.view, self.is_png, self.is_settled = VIEWS[view], png == 1, settled == 1
        self.pixels = struct.unpack("<9d", data[24:96]) if view else None
        self.picture = data[96 if view else 24:]
        begins = b"\x89PNG" if self.is_png else b"\xff\xd8"
        assert self.picture.startswith(begins), self.picture[:8]


class Refused(Exception):
    pass


class Closed(Exception):
    def __init__(self, code):
        super().__init__(f"closed with {code}")
        self.code = code


def handshake(port, token, target="/socket", **headers):
    """The bytes of a request for the socket; None leaves a header out."""
    fields = {"Host": f"127.0.0.1:{port}", "Upgrade": "websocket", "Connection": "Upgrade",
              "Sec-WebSocket-Key": base64.b64encode(os.urandom(16)).decode(),
              "Sec-WebSocket-Version": "13", "Sec-WebSocket-Protocol": f"supple.{token}"}
    fields.update({name.replace("_", "-"): value for name, value in headers.items()})
    lines = [f"{name}: {value}" for name, value in fields.items() if value is not None]
    return (f"GET {target} HTTP/1.1\r\n" + "\r\n".join(lines) + "\r\n\r\n").encode()


class Page:
    def __init__(self, port, token, acknowledges=True, **headers):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=30)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.buffer, self.parts = b"", []
        self.acknowledges = acknowledges
        self.n = self.drawn = 0  # the last message, and the last that changed pictures
        self.sizes = {}
        self.frames, self.answers, self.logs, self.progress = [], {}, [], []
        self.scene, self.hello, self.bye = None, None, None
        self.status, self.events = None, []  # of an operation
        self.socket.sendall(handshake(port, token, **headers))
        while b"\r\n\r\n" not in self.buffer:
            data = self.socket.recv(4096)
            if not data:
                raise Refused("no answer")
            self.buffer += data
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        if not head.startswith(b"HTTP/1.1 101"):
            raise Refused(head.split(b"\r\n")[0].decode())
        assert f"supple.{token}".encode() in head

    def close(self):
        self.socket.close()

    def send_raw(self, opcode, data, fin=True):
        mask = os.urandom(4)
        head = bytes([(0x80 if fin else 0) | opcode])
        if len(data) < 126:
            head += bytes([0x80 | len(data)])
        elif len(data) < 65536:
            head += struct.pack(">BH", 0x80 | 126, len(data))
        else:
            head += struct.pack(">BQ", 0x80 | 127, len(data))
        self.socket.sendall(head + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(data)))

    def send(self, **message):
        """Numbered, unless it is an ack; returns the number."""
        if "ack" not in message:
            self.n += 1
            message = {"n": self.n, **message}
            kind = message.get("event", {}).get("kind")
            if kind in DRAWN or "slices" in message or "deformed" in message:
                self.drawn = self.n
            self.sizes.update(message.get("size", {}))
        self.send_raw(TEXT, json.dumps(message).encode())
        return self.n

    def receive_raw(self, seconds):
        """(opcode, data), or None after so long."""
        deadline = time.monotonic() + seconds
        while True:
            frame = self._parse()
            if frame:
                return frame
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([self.socket], [], [], left)[0]:
                return None
            data = self.socket.recv(1 << 20)
            if not data:
                raise Closed(None)
            self.buffer += data

    def _parse(self):
        buffer = self.buffer
        if len(buffer) < 2:
            return None
        size, at = buffer[1] & 127, 2
        if size == 126:
            if len(buffer) < 4:
                return None
            size, at = struct.unpack(">H", buffer[2:4])[0], 4
        elif size == 127:
            if len(buffer) < 10:
                return None
            size, at = struct.unpack(">Q", buffer[2:10])[0], 10
        if len(buffer) < at + size:
            return None
        self.buffer = buffer[at + size:]
        self.parts.append((buffer[0] & 15, buffer[at:at + size]))
        if not buffer[0] & 0x80:
            return self._parse()
        parts, self.parts = self.parts, []
        return parts[0][0], b"".join(data for _, data in parts)

    def receive(self, seconds=20):
        """Takes in one message; False after so long without any."""
        got = self.receive_raw(seconds)
        if got is None:
            return False
        opcode, data = got
        if opcode == CLOSE:
            raise Closed(struct.unpack(">H", data[:2])[0] if len(data) >= 2 else None)
        if opcode == PING:
            self.send_raw(PONG, data)
        elif opcode == BINARY:
            frame = Frame(data)
            self.frames.append(frame)
            if self.acknowledges:
                self.send(ack=frame.number)
        elif opcode == TEXT:
            message = json.loads(data)
            if "re" in message:
                self.answers[message["re"]] = message
            elif "scene" in message:
                self.scene = message["scene"]
            elif "log" in message:
                self.logs.append(message["log"])
            elif "progress" in message:
                self.progress.append(message["progress"])
            elif "status" in message:
                self.status = message["status"]
            elif "events" in message:
                self.events += message["events"]
            elif "hello" in message:
                self.hello = message["hello"]
            else:
                self.bye = message["bye"]
        return True

    def until(self, is_there, seconds=30):
        deadline = time.monotonic() + seconds
        while not is_there():
            if not self.receive(max(0.01, deadline - time.monotonic())):
                raise TimeoutError("not within %g s; last log: %s" % (seconds, self.logs[-1:]))

    def ask(self, seconds=30, **message):
        """The answer's `ok`; raises RuntimeError with its `error`."""
        n = self.send(**message)
        self.until(lambda: n in self.answers, seconds)
        answer = self.answers.pop(n)
        if "error" in answer:
            raise RuntimeError(answer["error"])
        return answer["ok"]

    def hello_now(self):
        self.until(lambda: self.hello is not None)
        return self.hello

    def event(self, kind, **keys):
        return self.ask(event={"kind": kind, **keys})

    def last(self, view="3d"):
        frames = [frame for frame in self.frames if frame.view == view]
        return frames[-1] if frames else None

    def settle(self, event=None, view="3d", seconds=30):
        """Until a settled picture shows that event, or the last that changed pictures. Where nothing
        changes nothing is drawn."""
        wanted = self.drawn if event is None else event

        def is_settled():
            frame = self.last(view)
            return (frame is not None and frame.is_settled and frame.event >= wanted and
                    self.sizes.get(view, [frame.width, frame.height]) == [frame.width, frame.height])
        self.until(is_settled, seconds)
        return self.last(view)

    def carried_out(self, n=None, seconds=30):
        wanted = self.n if n is None else n
        self.until(lambda: self.scene and self.scene.get("event", 0) >= wanted, seconds)
        return self.scene


def ball_folder():
    folder = tempfile.TemporaryDirectory(prefix="supple-viewer-")
    write_ball(os.path.join(folder.name, "ball.nrrd"))
    return folder
