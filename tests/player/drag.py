"""Drags files onto a window, as a file manager does it: XDND, version 5.

    python -m tests.player.drag FILE...

Drops them on the topmost window that takes drops, and ends with 0 once that window has
said that it is finished. By ctypes and libX11, which every display with a window has.
"""

import ctypes
import sys
import time
from collections.abc import Iterator
from ctypes import POINTER, Structure, Union, byref, c_char_p, c_int, c_long, c_uint, c_ulong
from pathlib import Path

CLIENT_MESSAGE, SELECTION_REQUEST, SELECTION_NOTIFY = 33, 30, 31
ATOM = 4
PATIENCE = 10.0  # seconds


class ClientMessage(Structure):
    _fields_ = [
        ("type", c_int), ("serial", c_ulong), ("send_event", c_int), ("display", ctypes.c_void_p),
        ("window", c_ulong), ("message_type", c_ulong), ("format", c_int), ("data", c_long * 5),
    ]  # fmt: skip


class SelectionRequest(Structure):
    _fields_ = [
        ("type", c_int), ("serial", c_ulong), ("send_event", c_int), ("display", ctypes.c_void_p),
        ("owner", c_ulong), ("requestor", c_ulong), ("selection", c_ulong), ("target", c_ulong),
        ("property", c_ulong), ("time", c_ulong),
    ]  # fmt: skip


class SelectionNotify(Structure):
    _fields_ = [
        ("type", c_int), ("serial", c_ulong), ("send_event", c_int), ("display", ctypes.c_void_p),
        ("requestor", c_ulong), ("selection", c_ulong), ("target", c_ulong),
        ("property", c_ulong), ("time", c_ulong),
    ]  # fmt: skip


class Event(Union):
    _fields_ = [
        ("type", c_int), ("message", ClientMessage), ("request", SelectionRequest),
        ("notify", SelectionNotify), ("room", c_long * 24),
    ]  # fmt: skip


class Source:
    """The program that the files are dragged from."""

    def __init__(self, files: list[Path]) -> None:
        self.x11 = ctypes.CDLL("libX11.so.6")
        for name in ("XOpenDisplay", "XDefaultRootWindow", "XInternAtom", "XCreateSimpleWindow"):
            getattr(self.x11, name).restype = c_ulong
        self.display = ctypes.c_void_p(self.x11.XOpenDisplay(None))
        self.root = c_ulong(self.x11.XDefaultRootWindow(self.display))
        window = self.x11.XCreateSimpleWindow(
            self.display, self.root, 0, 0, 1, 1, 0, c_ulong(0), c_ulong(0)
        )
        self.window = c_ulong(window)
        self.list = "".join(f"{file.absolute().as_uri()}\r\n" for file in files).encode()

    def atom(self, name: str) -> int:
        return int(self.x11.XInternAtom(self.display, c_char_p(name.encode()), 0))

    def target(self) -> int:
        """The topmost window that takes drops."""
        return [w for w in self._windows(self.root.value) if self._takes_drops(w)][-1]

    def _windows(self, parent: int) -> Iterator[int]:
        root, above, children, count = c_ulong(), c_ulong(), POINTER(c_ulong)(), c_uint()
        self.x11.XQueryTree(
            self.display, c_ulong(parent), byref(root), byref(above), byref(children), byref(count)
        )
        for place in range(count.value):
            yield children[place]
            yield from self._windows(children[place])

    def _takes_drops(self, window: int) -> bool:
        kind, size, count, rest = c_ulong(), c_int(), c_ulong(), c_ulong()
        found = POINTER(ctypes.c_ubyte)()
        self.x11.XGetWindowProperty(
            self.display, c_ulong(window), c_ulong(self.atom("XdndAware")), c_long(0), c_long(1), 0,
            c_ulong(ATOM), byref(kind), byref(size), byref(count), byref(rest), byref(found),
        )  # fmt: skip
        return count.value > 0

    def send(self, window: int, name: str, *data: int) -> None:
        event = Event()
        event.message = ClientMessage(
            CLIENT_MESSAGE, 0, 1, self.display, window, self.atom(name), 32, (c_long * 5)(*data)
        )
        self.x11.XSendEvent(self.display, c_ulong(window), 0, c_long(0), byref(event))
        self.x11.XFlush(self.display)

    def drop(self, x: int, y: int) -> None:
        """On the window, at a place of the screen."""
        window, me, kind = self.target(), self.window.value, self.atom("text/uri-list")
        self.x11.XSetSelectionOwner(
            self.display, c_ulong(self.atom("XdndSelection")), self.window, c_ulong(0)
        )
        self.send(window, "XdndEnter", me, 5 << 24, kind)
        self.send(window, "XdndPosition", me, 0, x << 16 | y, 0, self.atom("XdndActionCopy"))
        self._until("XdndStatus")
        self.send(window, "XdndDrop", me, 0, 0)
        self._until("XdndFinished")

    def _until(self, name: str) -> None:
        """Answer what is asked, until the window says so."""
        event, wanted, deadline = Event(), self.atom(name), time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            if not self.x11.XPending(self.display):
                time.sleep(0.01)
                continue
            self.x11.XNextEvent(self.display, byref(event))
            if event.type == SELECTION_REQUEST:
                self._give(event.request)
            if event.type == CLIENT_MESSAGE and event.message.message_type == wanted:
                if name == "XdndStatus" and not event.message.data[1] & 1:
                    raise SystemExit("the window refuses the files")
                return
        raise SystemExit(f"no {name} came")

    def _give(self, asked: SelectionRequest) -> None:
        self.x11.XChangeProperty(
            self.display, c_ulong(asked.requestor), c_ulong(asked.property), c_ulong(asked.target),
            8, 0, c_char_p(self.list), len(self.list),
        )  # fmt: skip
        answer = Event()
        answer.notify = SelectionNotify(
            SELECTION_NOTIFY, 0, 1, self.display, asked.requestor, asked.selection, asked.target,
            asked.property, asked.time,
        )  # fmt: skip
        self.x11.XSendEvent(self.display, c_ulong(asked.requestor), 0, c_long(0), byref(answer))
        self.x11.XFlush(self.display)


if __name__ == "__main__":
    Source([Path(name) for name in sys.argv[1:]]).drop(100, 100)
