"""Hosts in network namespaces, and links that a test delays, loses and cuts.

The namespaces and their devices exist as long as a process is in them, so nothing has to be removed. The switch is in
this process: it needs no kernel module for delay and loss.
"""

import ctypes
import fcntl
import heapq
import itertools
import os
import random
import select
import struct
import subprocess
import threading
import time
from contextlib import ExitStack, suppress
from dataclasses import dataclass

CLONE_NEWNET = 0x40000000
TUNSETIFF, IFF_TAP, IFF_NO_PI = 0x400454CA, 0x0002, 0x1000
LARGEST_FRAME = 65536


class NotPermittedError(Exception):
    """This process cannot make network namespaces."""


@dataclass
class Link:
    """A host's link to the switch: delay of each frame in seconds, probability of its loss, and whether it is cut."""

    delay: float = 0.0
    loss: float = 0.0
    cut: bool = False


class Network:
    """A switch between hosts: number 1 is a new network namespace of this process, the others are separate.

    Create it before the first thread, which would stay in the old namespace. Raises NotPermittedError.
    """

    def __init__(self, hosts):
        self._unshare()
        self._stack = ExitStack()
        self._links, self._ports, self._spaces = {}, {}, {}
        self._random = random.Random(1)
        self._ended = threading.Event()
        for number in range(1, hosts + 1):
            self._add(number)
        self._switch = threading.Thread(target=self._forward, daemon=True)
        self._switch.start()
        self._stack.callback(self._switch.join)
        self._stack.callback(self._ended.set)
        self.close = self._stack.close

    @staticmethod
    def _unshare():
        if ctypes.CDLL(None, use_errno=True).unshare(CLONE_NEWNET) != 0:
            raise NotPermittedError(f"unshare: {os.strerror(ctypes.get_errno())}")

    def _add(self, number):
        name = f"tap{number}"
        try:
            port = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
            self._stack.callback(os.close, port)
            fcntl.ioctl(port, TUNSETIFF, struct.pack("16sH22x", name.encode(), IFF_TAP | IFF_NO_PI))
        except OSError as error:
            raise NotPermittedError(f"/dev/net/tun: {error.strerror}") from error
        self._ports[port], self._links[number] = number, Link()
        if number > 1:
            space = subprocess.Popen(["sleep", "infinity"], preexec_fn=self._unshare)
            self._stack.callback(space.wait)
            self._stack.callback(space.kill)
            self._spaces[number] = space.pid
            subprocess.run(["ip", "link", "set", name, "netns", str(space.pid)], check=True)
        for words in (f"addr add {self.address(number)}/24 dev {name}", f"link set {name} up", "link set lo up"):
            subprocess.run([*self._enter(number), "ip", *words.split()], check=True)

    @staticmethod
    def address(number):
        """Return the address of a host."""
        return f"10.99.0.{number}"

    def _enter(self, number):
        return ["nsenter", f"--net=/proc/{self._spaces[number]}/ns/net"] if number > 1 else []

    def start(self, number, log, *command):
        """Start a command on a host, in a session of its own; its output goes to the file ``log``."""
        environment = {**os.environ, "ROS_IP": self.address(number)}
        with open(log, "ab") as output:
            return subprocess.Popen(
                [*self._enter(number), *command],
                stdout=output,
                stderr=subprocess.STDOUT,
                env=environment,
                start_new_session=True,
            )

    def link(self, number):
        """Return the link of a host, to be changed at any time."""
        return self._links[number]

    def _forward(self):
        count, waiting = itertools.count(), []
        while not self._ended.is_set():
            now = time.monotonic()
            pause = min(0.1, max(0.0, waiting[0][0] - now)) if waiting else 0.1
            for port in select.select(list(self._ports), [], [], pause)[0]:
                with suppress(OSError):
                    frame = os.read(port, LARGEST_FRAME)
                    for other in self._ports:
                        if other != port and not self._is_lost(port, other):
                            heapq.heappush(waiting, (self._due(port, other), next(count), port, other, frame))
            while waiting and waiting[0][0] <= time.monotonic():
                _, _, port, other, frame = heapq.heappop(waiting)
                if not self._is_cut(port, other):
                    with suppress(OSError):
                        os.write(other, frame)

    def _both(self, port, other):
        return [self._links[self._ports[one]] for one in (port, other)]

    def _is_cut(self, port, other):
        return any(link.cut for link in self._both(port, other))

    def _is_lost(self, port, other):
        lost = any(self._random.random() < link.loss for link in self._both(port, other))
        return lost or self._is_cut(port, other)

    def _due(self, port, other):
        return time.monotonic() + sum(link.delay for link in self._both(port, other))
