"""Requests that must fail, beside a live session that none of them may disturb: after each the page
drags on and sees it, and the session still says the same of itself."""
import json
import os
import socket
import struct
import sys
import tempfile
import time

from page import BINARY, CLOSE, PING, TEXT, Closed, Page, Refused, Server, ball_folder, handshake

SECRET = "the secret of a file outside"
SCRATCH = tempfile.TemporaryDirectory(prefix="supple-scratch-")  # of the server


def connect(server):
    return socket.create_connection(("127.0.0.1", server.port), timeout=15)


def answer_to(server, request, seconds=15):
    """All that the server says to these bytes until it closes, or falls silent."""
    with connect(server) as raw:
        raw.settimeout(seconds)
        data = b""
        try:
            raw.sendall(request)
            while True:
                more = raw.recv(65536)
                data += more
                if not more or (b"\r\n\r\n" in data and b"Connection: close" not in data):
                    return data
        except (TimeoutError, ConnectionError):
            return data


def get(server, target="/", host=None, more=""):
    host = f"127.0.0.1:{server.port}" if host is None else host
    return answer_to(server, f"GET {target} HTTP/1.1\r\nHost: {host}\r\n{more}\r\n".encode("latin-1"))


def is_status(data, *statuses):
    return any(data.startswith(b"HTTP/1.1 %d" % status) for status in statuses)


def refuses(data, *statuses):
    assert is_status(data, *(statuses or (403, 404))), data[:200]
    assert SECRET.encode() not in data, "the secret"


def refuses_socket(server, token=None, **headers):
    try:
        Page(server.port, server.token if token is None else token, **headers)
    except (Refused, ConnectionError):
        return
    raise AssertionError(f"a socket in spite of {token} {headers}")


def closes(server, send, *codes):
    """A page that sends this is closed, with one of the codes, or just cut off."""
    page = Page(server.port, server.token)
    try:
        send(page)
        deadline = time.monotonic() + 15
        while time.monotonic() < deadline:
            page.receive(0.5)
    except Closed as closed:
        assert closed.code is None or closed.code in codes, closed
        return
    except (ConnectionError, BrokenPipeError):
        return
    finally:
        page.close()
    raise AssertionError("the connection stays")


def error_of(server, **message):
    page = Page(server.port, server.token)
    try:
        page.ask(**message)
    except RuntimeError as error:
        assert SECRET not in str(error), error
        return
    finally:
        page.close()
    raise AssertionError(f"no error of {message}")


def flood(page, seconds=5):
    """As many messages as go, up to 10^5 a second."""
    message = json.dumps({"ack": 1}).encode()
    one = bytes([0x81, 0x80 | len(message)]) + b"\0\0\0\0" + message
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        page.socket.sendall(one * 10000)


def half_open(server, count=200):
    """Connections that say nothing or a piece of a request; then a page must still get in."""
    held = [connect(server) for _ in range(count)]
    for raw in held[::2]:
        try:
            raw.sendall(b"GET / HTTP/1.1\r\nHost: ")
        except ConnectionError:
            pass
    assert is_status(get(server), 200)
    Page(server.port, server.token).close()
    for raw in held:
        raw.close()


def slow_loris(server):
    """A byte of a header now and then does not keep a connection for ever."""
    with connect(server) as raw:
        raw.sendall(b"GET / HTTP/1.1\r\nX: ")
        begun = time.monotonic()
        try:
            while time.monotonic() - begun < 25:
                raw.sendall(b"a")
                time.sleep(0.5)
        except ConnectionError:
            return
    raise AssertionError("a request of 25 seconds")


def vanish(server):
    """Sockets that are reset while pictures come."""
    for _ in range(10):
        page = Page(server.port, server.token)
        page.send(pick={"view": "3d", "at": [48, 48]})
        page.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        page.close()


def raw_message(text):
    data = text if isinstance(text, bytes) else text.encode()
    return lambda page: page.send_raw(TEXT, data)


def announced(server, name="a.vdb", size=8):
    """A page that has announced a file, and the address of it."""
    page = Page(server.port, server.token)
    return page, f"{page.ask(drop={'files': [{'name': name, 'bytes': size}]})}/0"


def post(server, target, body=b"", token=None, length=None, more=""):
    """What the server says to a file that is sent."""
    length = len(body) if length is None else length
    key = server.token if token is None else token
    return answer_to(server, (
        f"POST /drop/{target} HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n"
        f"Authorization: Bearer {key}\r\n{more}" +
        ("" if length < 0 else f"Content-Length: {length}\r\n") + "\r\n").encode() + body)


def upload(server, size=8, statuses=(409,), **how):
    """Refused, and the file can still be sent as it was announced; then nothing stays of it."""
    page, target = announced(server, size=size)
    refuses(post(server, target, **how), *statuses)
    assert is_status(post(server, target, b"x" * size), 200)
    refuses(post(server, target, length=size), 409)  # once
    page.close()
    no_copies()


def unannounced(server):
    refuses(post(server, "1/0", length=8), 409)
    page, target = announced(server)
    for other in ("", "/", "../a", target + "/0", target[:-1] + "1", "-1/0", "9" * 30 + "/0"):
        refuses(post(server, other, length=8), 409)
    page.close()


def half_sent(server):
    """Files of which a part comes, and then the end of the connection, or nothing."""
    page, target = announced(server, size=1 << 20)
    for resets in (False, True):
        raw = connect(server)
        raw.sendall((f"POST /drop/{target} HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nAuthorization: "
                     f"Bearer {server.token}\r\nContent-Length: {1 << 20}\r\n\r\n").encode() + b"x" * 50000)
        time.sleep(0.2)
        if resets:
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            raw.close()
            continue
        begun = time.monotonic()
        raw.settimeout(15)
        try:
            assert raw.recv(100) == b""
        except ConnectionError:
            pass
        assert time.monotonic() - begun < 14, "it waits for ever"
        raw.close()
    time.sleep(0.2)
    assert copies() == [], copies()
    try:
        page.ask(open={"drop": int(target.split("/")[0])})
        raise AssertionError("a file was opened that is not there")
    except RuntimeError as error:
        assert "a.vdb" in str(error), error
    page.close()
    no_copies()


def copies():
    return [name for _, _, names in os.walk(SCRATCH.name) for name in names]


def no_copies():
    """A page that is gone takes its files with it."""
    for _ in range(50):
        if not copies():
            return
        time.sleep(0.1)
    raise AssertionError(copies())


def dropped(server, contents):
    """A file of these contents is sent and opened: one line says why not."""
    page, target = announced(server, "a.toml", len(contents))
    assert is_status(post(server, target, contents), 200)
    try:
        page.ask(open={"drop": int(target.split("/")[0])})
        raise AssertionError("it was opened")
    except RuntimeError as error:
        assert SECRET not in str(error) and "\n" not in str(error), error
    assert copies() == [], copies()
    page.close()


def nested(depth):
    return '{"event": ' + '{"kind": ' * depth + "1" + "}" * depth + "}"


def attacks(server, folder):
    port = server.port
    evil = "http://evil.example"
    up = "../" + os.path.basename(folder + "-outside") + "/secret.toml"
    outside = os.path.realpath(folder) + "-outside/secret.toml"
    huge = struct.pack(">BBQ", 0x81, 0x80 | 127, 1 << 30) + b"\0\0\0\0" + b"x" * 4096
    return {
        "foreign Host": lambda: refuses(get(server, host="evil.example")),
        "foreign Host with the port": lambda: refuses(get(server, host=f"evil.example:{port}")),
        "Host without port": lambda: refuses(get(server, host="127.0.0.1")),
        "no Host": lambda: refuses(answer_to(server, b"GET / HTTP/1.1\r\n\r\n"), 403, 400),
        "two Hosts": lambda: refuses(get(server, more="Host: evil.example\r\n"), 403, 400),
        "foreign Origin": lambda: refuses(get(server, more=f"Origin: {evil}\r\n")),
        "Origin null": lambda: refuses(get(server, more="Origin: null\r\n")),
        "socket of a foreign Origin": lambda: refuses_socket(server, Origin=evil),
        "socket of a foreign Host": lambda: refuses_socket(server, Host=f"evil.example:{port}"),
        "socket by DNS rebinding": lambda: refuses_socket(
            server, Host=f"evil.example:{port}", Origin=f"http://evil.example:{port}"),
        "socket without token": lambda: refuses_socket(server, Sec_WebSocket_Protocol=None),
        "socket with a wrong token": lambda: refuses_socket(server, token="0" * 32),
        "socket with a shorter token": lambda: refuses_socket(server, token=server.token[:-1]),
        "socket with the token as a query": lambda: refuses(answer_to(
            server, handshake(port, "").replace(b"/socket", b"/socket?supple." +
                                                server.token.encode())), 403, 404),
        "traversal": lambda: refuses(get(server, "/../../../../etc/passwd")),
        "encoded traversal": lambda: refuses(get(server, "/%2e%2e/%2e%2e/etc/passwd")),
        "an absolute target": lambda: refuses(get(server, "//etc/passwd")),
        "a method that writes": lambda: refuses(answer_to(
            server, f"DELETE / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode()), 405),
        "a body": lambda: refuses(answer_to(
            server, (f"POST / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Length: 100000000000"
                     "\r\n\r\n").encode() + b"x" * 10000) or b"HTTP/1.1 405", 400, 405, 413),
        "headers of a megabyte": lambda: no_success(answer_to(
            server, b"GET / HTTP/1.1\r\nX: " + b"a" * (1 << 20) + b"\r\n\r\n")),
        "binary garbage instead of HTTP": lambda: no_success(answer_to(server, os.urandom(65536))),
        "a file outside": lambda: error_of(server, open={"path": outside}),
        "a file outside by ..": lambda: error_of(server, open={"path": up}),
        "a link that leads out": lambda: error_of(server, open={"path": "link.toml"}),
        "listing what is outside": lambda: error_of(server, list={"path": "/etc"}),
        "listing by a link": lambda: error_of(server, list={"path": "folder-link"}),
        "writing outside": lambda: error_of(
            server, save={"what": "journal", "path": outside, "force": True}),
        "writing through a link": lambda: error_of(
            server, save={"what": "journal", "path": "link.toml", "force": True}),
        "reading a file in an event": lambda: error_of(
            server, event={"kind": "look", "transfer": outside}),
        "reading a camera file in an event": lambda: error_of(
            server, event={"kind": "camera", "camera": outside}),
        "a scene whose volume lies outside": lambda: error_of(server, open={"path": "escape.toml"}),
        "a scene whose look lies outside": lambda: error_of(server, open={"path": "escape_look.toml"}),
        "a journal whose look lies outside": lambda: error_of(server, open={"path": "escape_event.toml"}),
        "a name with a line break": lambda: error_of(
            server, save={"what": "journal", "path": "a\nb.toml"}),
        "a name with a control character": lambda: error_of(
            server, save={"what": "journal", "path": "a\x7fb.toml"}),
        "going on with nothing": lambda: error_of(server, go_on=True),
        "a message of 1 GB": lambda: closes(server, lambda page: page.socket.sendall(huge), 1009),
        "a message of 2 MB": lambda: closes(server, raw_message("[" + "1," * (1 << 20) + "1]"), 1009),
        "10^5 messages a second": lambda: closes(server, flood, 1008),
        "broken UTF-8": lambda: closes(server, raw_message(b'{"list": {"path": "\xff\xfe"}}'), 1007),
        "no JSON": lambda: closes(server, raw_message("{"), 1007),
        "a list": lambda: closes(server, raw_message("[1]"), 1007),
        "an unknown verb": lambda: closes(server, raw_message('{"n": 1, "shell": "ls"}'), 1007),
        "two verbs": lambda: closes(server, raw_message('{"presets": true, "cancel": true}'), 1007),
        "deep nesting": lambda: closes(server, raw_message(nested(100000)), 1007),
        "a number beyond all": lambda: closes(server, raw_message('{"n": 1e999, "cancel": true}'),
                                              1007),
        "a binary message": lambda: closes(server, lambda page: page.send_raw(BINARY, b"x"), 1003),
        "a reserved opcode": lambda: closes(server, lambda page: page.send_raw(3, b"x"), 1002),
        "a ping that is too long": lambda: closes(
            server, lambda page: page.send_raw(PING, b"x" * 200), 1002),
        "an unmasked message": lambda: closes(
            server, lambda page: page.socket.sendall(b"\x81\x02{}"), 1002),
        "a close with a code that is none": lambda: closes(
            server, lambda page: page.send_raw(CLOSE, struct.pack(">H", 5)), 1002),
        "garbage behind the handshake": lambda: closes(
            server, lambda page: page.socket.sendall(os.urandom(100000)), 1002, 1007, 1009, 1003),
        "a file without token": lambda: upload(server, statuses=(403,), token="", length=8),
        "a file with a wrong token": lambda: upload(server, statuses=(403,), token="0" * 32, length=8),
        "a file with two tokens": lambda: upload(
            server, statuses=(403,), length=8, more=f"Authorization: Bearer {server.token}\r\n"),
        "a file from elsewhere": lambda: upload(
            server, statuses=(403,), length=8, more=f"Origin: {evil}\r\n"),
        "a file without a length": lambda: upload(server, statuses=(411,), length=-1),
        "a file in chunks": lambda: upload(
            server, statuses=(411,), length=-1, more="Transfer-Encoding: chunked\r\n"),
        "a longer file": lambda: upload(server, length=9),
        "a file of 2^63": lambda: upload(server, statuses=(409, 400), length=1 << 63),
        "a file that nobody announced": lambda: unannounced(server),
        "half a file": lambda: half_sent(server),
        "a file with folders in its name": lambda: error_of(
            server, drop={"files": [{"name": "../../a.toml", "bytes": 1}]}),
        "a file of a terabyte": lambda: error_of(
            server, drop={"files": [{"name": "a.raw", "bytes": 10**12}]}),
        "a file of less than nothing": lambda: error_of(
            server, drop={"files": [{"name": "a.raw", "bytes": -1}]}),
        "a dropped scene whose volume lies outside": lambda: dropped(
            server, b'[volume]\npath = "/etc/passwd"\n'),
        "a dropped scene by ..": lambda: dropped(
            server, f'[volume]\npath = "../../../../{outside}"\n'.encode()),
        "sockets that vanish": lambda: vanish(server),
        "200 half-open connections": lambda: half_open(server),
        "a slow loris": lambda: slow_loris(server),
    }


def no_success(data):
    assert not is_status(data, 200, 101), data[:200]


class Witness:
    """The live session beside the attacks."""

    def __init__(self, server):
        self.page = Page(server.port, server.token)
        self.page.until(lambda: self.page.scene is not None)
        self.page.ask(size={"3d": [96, 96]})
        self.page.event("grab", grab=self.page.ask(
            pick={"view": "3d", "at": [48.5, 48.5]})["voxel"])
        self.elements = self.page.scene["volume"]["elements"]
        self.worst = 0
        self.step = 0

    def check(self):
        """Drags on, and sees it."""
        self.step += 1
        begun = time.monotonic()
        self.page.event("drag", to=[0.3 + 0.01 * (self.step % 40), 0, 0])
        n = self.page.n
        self.page.until(lambda: self.page.last() and self.page.last().event >= n, 10)
        self.worst = max(self.worst, time.monotonic() - begun)
        assert self.page.scene["volume"]["elements"] == self.elements
        assert self.page.hello["version"]


def main():
    with ball_folder() as folder:
        os.mkdir(folder + "-outside")
        try:
            with open(folder + "-outside/secret.toml", "w") as secret:
                secret.write(f'"{SECRET}" = 1\n')
            os.symlink(folder + "-outside/secret.toml", folder + "/link.toml")
            os.symlink(folder + "-outside", folder + "/folder-link")
            with open(folder + "/escape.toml", "w") as scene:
                scene.write('[volume]\npath = "/etc/passwd"\n')
            for name, table in (("look", '[[view]]\nimage = "a.png"\n'),
                                ("event", '[[event]]\nkind = "look"\n')):
                with open(f"{folder}/escape_{name}.toml", "w") as scene:
                    scene.write(f'[volume]\npath = "ball.nrrd"\n{table}transfer = "link.toml"\n')
            run_all(folder)
            assert not any(name.startswith("a") for name in os.listdir(folder)), os.listdir(folder)
        finally:
            os.remove(folder + "-outside/secret.toml")
            os.rmdir(folder + "-outside")


def run_all(folder):
    os.environ["TMPDIR"] = SCRATCH.name
    with Server("ball.nrrd", "--material", "uniform", "--size", "96,96", folder=folder) as server:
        witness = Witness(server)
        before = server.memory_mb()
        failures = 0
        everything = attacks(server, folder)
        for name, attack in everything.items():
            try:
                attack()
                witness.check()
            except Exception as error:  # every one is told, and the next one tried
                print(f"FAILED {name}: {type(error).__name__}: {error}", flush=True)
                failures += 1
                if server.process.poll() is not None:
                    break
        grown = server.memory_mb() - before
        print(f"{len(everything)} attacks, {failures} failures, memory grew by {grown:.0f} MB, the "
              f"slowest drag beside them took {1000 * witness.worst:.0f} ms")
        assert server.process.poll() is None, "the server is gone"
        no_copies()
        assert failures == 0
        assert grown < 100, "what attackers send is kept"


if __name__ == "__main__":
    try:
        main()
    except (AssertionError, RuntimeError, TimeoutError) as error:
        print(f"{type(error).__name__}: {error}")
        sys.exit(1)
