"""Runs the editor as a process and talks to it as a page does, with Python's standard library alone."""

import base64
import json
import os
import socket
import struct
import subprocess
import urllib.parse


class Gone(Exception):
    """Raised when the connection has ended."""


class Engine:
    """A running `meshgraft edit`, which ends with its `with` block."""

    def __init__(self, program, *arguments, cwd=None, limits=None, env=None):
        self.process = subprocess.Popen(
            [program, "edit", "--no-browser", "--port", "0", *map(str, arguments)],
            cwd=cwd, preexec_fn=limits, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, **(env or {})})
        self.url = self.process.stdout.readline().strip()
        if not self.url:
            raise RuntimeError(self.process.stderr.read())

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()

    def page(self):
        return Page(self.url)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def end(self, signal, patience=10):
        """Sends a signal and returns the exit status."""
        self.process.send_signal(signal)
        return self.process.wait(patience)

    def peak_memory(self):
        """Returns the peak of resident memory in bytes."""
        with open(f"/proc/{self.process.pid}/status") as status:
            return next(int(line.split()[1]) * 1024 for line in status if line.startswith("VmHWM"))


class Page:
    """A WebSocket that sends requests and waits for their answers. It keeps only the headers of frames."""

    def __init__(self, url):
        parts = urllib.parse.urlsplit(url)
        self.host, self.port, self.query = parts.hostname, parts.port, parts.query
        self.socket = socket.create_connection((self.host, self.port), timeout=60)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(
            f"GET /session?{self.query} HTTP/1.1\r\nHost: {parts.netloc}\r\nOrigin: http://{parts.netloc}\r\n"
            f"Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
            f"Sec-WebSocket-Key: {key}\r\n\r\n".encode())
        self.buffer, self.last_id, self.events, self.replies, self.frames = b"", 0, [], {}, []
        while b"\r\n\r\n" not in self.buffer:
            self.buffer += self._receive()
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        if b" 101 " not in head.split(b"\r\n")[0]:
            raise RuntimeError(head.decode())

    def close(self):
        self.socket.close()

    def send(self, request):
        """Sends without waiting, and returns the request's number."""
        self.last_id += 1
        self._send_fragment(1, json.dumps({**request, "id": self.last_id}).encode())
        return self.last_id

    def reply_to(self, number):
        while number not in self.replies:
            self._take()
        return self.replies.pop(number)

    def ask(self, request):
        """Sends a request and returns its result."""
        reply = self.reply_to(self.send(request))
        if "error" in reply:
            raise AssertionError(f"{request}: {reply['error']}")
        return reply["result"]

    def refusal(self, request):
        """Sends a request and returns its error."""
        reply = self.reply_to(self.send(request))
        if "error" not in reply:
            raise AssertionError(f"{request} was not refused")
        return reply["error"]

    def event(self, name, is_right=lambda event: True):
        """Waits for an event. Earlier events that were not taken count."""
        while True:
            for index, event in enumerate(self.events):
                if event["event"] == name and is_right(event):
                    return self.events.pop(index)
            self._take()

    def frame(self, is_right):
        """Waits for a frame, and returns its header."""
        while True:
            for index, header in enumerate(self.frames):
                if is_right(header):
                    del self.frames[:index + 1]
                    return header
            self._take()

    def exact(self, pose):
        return self.frame(lambda header: header.get("accuracy") == "exact" and header["pose"] == pose)

    def upload(self, name, parts):
        """Sends a file in parts, chunked, and returns the status and the text of the answer."""
        address = f"{self.host}:{self.port}"
        connection = socket.create_connection((self.host, self.port), timeout=60)
        with connection:
            connection.sendall(
                f"POST /upload?{self.query}&name={name} HTTP/1.1\r\nHost: {address}\r\n"
                f"Origin: http://{address}\r\nTransfer-Encoding: chunked\r\n\r\n".encode())
            answer = b""
            try:
                for part in parts:
                    connection.sendall(b"%x\r\n" % len(part) + part + b"\r\n")
                connection.sendall(b"0\r\n\r\n")
            except OSError:
                pass  # the server may refuse before all is sent
            try:
                while b"\r\n\r\n" not in answer or not answer.split(b"\r\n\r\n", 1)[1]:
                    more = connection.recv(65536)
                    if not more:
                        break
                    answer += more
            except OSError:
                pass
        head, _, body = answer.partition(b"\r\n\r\n")
        return int(head.split()[1]) if head else 0, body.decode()

    def _send_fragment(self, kind, data):
        mask = os.urandom(4)
        length = len(data)
        head = struct.pack("!BB", 0x80 | kind, 0x80 | length) if length < 126 else (
            struct.pack("!BBH", 0x80 | kind, 0x80 | 126, length) if length < 65536 else
            struct.pack("!BBQ", 0x80 | kind, 0x80 | 127, length))
        masked = (int.from_bytes(data, "big") ^
                  int.from_bytes((mask * (length // 4 + 1))[:length], "big")).to_bytes(length, "big")
        try:
            self.socket.sendall(head + mask + masked)
        except OSError as error:
            raise Gone from error

    def _receive(self):
        try:
            data = self.socket.recv(1 << 16)
        except TimeoutError:
            raise
        except OSError as error:
            raise Gone from error
        if not data:
            raise Gone
        return data

    def _need(self, count):
        parts, have = [self.buffer], len(self.buffer)
        while have < count:
            parts.append(self._receive())
            have += len(parts[-1])
        data = b"".join(parts)
        self.buffer = data[count:]
        return data[:count]

    def _fragment(self):
        """Returns whether a fragment is the last of its message, its kind (0: continuation), and its bytes."""
        first, second = self._need(2)
        length = second & 127
        if length == 126:
            length, = struct.unpack("!H", self._need(2))
        elif length == 127:
            length, = struct.unpack("!Q", self._need(8))
        return first & 0x80 != 0, first & 15, self._need(length)

    def _take(self):
        is_last, kind, data = self._fragment()
        while not is_last:
            is_last, more_kind, more = self._fragment()
            data += more if more_kind == 0 else b""
        if kind == 8:
            raise Gone
        if kind == 9:
            self._send_fragment(10, data)  # a pong
        if kind == 1:
            message = json.loads(data)
            if "event" in message:
                self.events.append(message)
            else:
                self.replies[message["re"]] = message
        elif kind == 2:
            size, = struct.unpack_from("<I", data, 8)
            self.frames.append(json.loads(data[12:12 + size]))

