"""Plants and tests in Python for onescan. `Simulation` is where to begin; README.md has examples."""
from .campaign import Table, campaign
from .errors import CampaignFailed, LockstepError, LostServer, ProtocolError, Refused, SessionEnded, SessionFailed
from .protocol import Fields, LockstepClient, Participant, Signals
from .simulation import Input, Output, Signal, Simulation
from .streams import Line, ListeningPort, SerialPort
from .values import Value

__all__ = [
    "CampaignFailed", "Fields", "Input", "Line", "ListeningPort", "LockstepClient", "LockstepError", "LostServer",
    "Output", "Participant", "ProtocolError", "Refused", "SerialPort", "SessionEnded", "SessionFailed", "Signal",
    "Signals", "Simulation", "Table", "Value", "campaign",
]
__version__ = "0.2.0"
