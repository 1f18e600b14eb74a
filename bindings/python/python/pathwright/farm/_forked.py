"""Imported by the process that workers on this machine are forked from: Ctrl-C is for the client, which ends them."""

import signal

from . import _guard as _guard

signal.signal(signal.SIGINT, signal.SIG_IGN)
