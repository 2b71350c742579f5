"""What can go wrong; section numbers are those of PROTOCOL.md."""
from __future__ import annotations

import json
from typing import Any, Dict


class LockstepError(Exception):
    """Base of all that this package raises."""


class ProtocolError(LockstepError):
    """The server broke the protocol."""


class Refused(LockstepError):
    """The server answered `refused` (section 3.1)."""


class LostServer(LockstepError):
    """No connection, no answer in time, or the connection closed without `end` (section 3.5)."""


class SessionEnded(LockstepError):
    """Completed or stopped (section 3.5) before this client had joined; `run` returns such an `end`."""

    def __init__(self, end: Dict[str, Any]) -> None:
        super().__init__(json.dumps(end))
        self.end = end


class SessionFailed(SessionEnded):
    """The session failed, or this client's own `fault` ended it (sections 3.3 and 3.5)."""


class CampaignFailed(LockstepError):
    """`onescan campaign` came to no table; the text is what it said."""
