"""Plants and tests in Python for onescan. `Simulation` is where to begin; README.md has examples."""
from .errors import LockstepError, LostServer, ProtocolError, Refused, SessionEnded, SessionFailed
from .protocol import Fields, LockstepClient, Participant, Signals
from .simulation import Input, Output, Signal, Simulation
from .streams import Line, ListeningPort, SerialPort
from .values import Value

__all__ = [
    "Fields", "Input", "Line", "ListeningPort", "LockstepClient", "LockstepError", "LostServer", "Output", "Participant", "ProtocolError",
    "Refused", "SerialPort", "SessionEnded", "SessionFailed", "Signal", "Signals", "Simulation", "Value",
]
__version__ = "0.1.0"
