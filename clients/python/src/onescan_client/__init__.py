"""Plants and tests in Python for onescan. `Simulation` is where to begin; README.md has examples."""
from .errors import LockstepError, LostServer, ProtocolError, Refused, SessionEnded, SessionFailed
from .protocol import Fields, LockstepClient, Participant, Signals
from .simulation import Input, Output, Signal, Simulation
from .values import Value

__all__ = [
    "Fields", "Input", "LockstepClient", "LockstepError", "LostServer", "Output", "Participant", "ProtocolError",
    "Refused", "SessionEnded", "SessionFailed", "Signal", "Signals", "Simulation", "Value",
]
__version__ = "0.1.0"
