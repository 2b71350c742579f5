"""A PLC on `pyads`' test server. Prints its port; runs until it is ended."""

import struct
import time

from pyads import constants
from pyads.testserver import AdsTestServer, AdvancedHandler, PLCVariable

from shear import INPUTS, OUTPUTS, WORDS_IN, WORDS_OUT, Plc

# struct's letter, ADS type and the name of the type; a symbol of the shim is in the list SDSP.
FORMS = {
    "Shear.Position_1": ("<d", constants.ADST_REAL64, "LREAL"),
    "Shear.Position_2": ("<d", constants.ADST_REAL64, "LREAL"),
    "SDSP_TV": ("<q", constants.ADST_INT64, "LINT"),
    "SDSP_Answer": ("<h", constants.ADST_INT16, "INT"),
    "Alignment.AlignedCount": ("<i", constants.ADST_INT32, "DINT"),
    "Shear.Strokes": ("<i", constants.ADST_INT32, "DINT"),
}
UDINT = ("<I", constants.ADST_UINT32, "UDINT")
BOOL = ("<?", constants.ADST_BIT, "BOOL")


def form(name):
    return FORMS.get(name, UDINT if name.startswith("SDSP") else BOOL)


def variable(name):
    letter, ads_type, type_name = form(name)
    path = f"SDSP.{name}" if name.startswith("SDSP") else name
    return PLCVariable(path, struct.pack(letter, 0), ads_type, type_name)


handler = AdvancedHandler()
variables = {name: variable(name) for name in INPUTS + WORDS_IN + WORDS_OUT + OUTPUTS}
for each in variables.values():
    handler.add_variable(each)
server = AdsTestServer(handler=handler, port=0, logging=False)
server.start()
print(server.server.getsockname()[1], flush=True)
plc = Plc()
while True:
    # The grant is taken first: all that is written before it is there then.
    taken = {name: struct.unpack(form(name)[0], variables[name].value)[0] for name in reversed(INPUTS + WORDS_IN)}
    given = plc.cycle(taken)
    # The words are given last, and so are the outputs there when they are.
    for name in OUTPUTS + WORDS_OUT[::-1]:
        variables[name].value = struct.pack(form(name)[0], given[name])
    time.sleep(0.001)
