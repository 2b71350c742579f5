"""A simulation as a class: signals are attributes, a step is a method, its state is saved by itself."""
from __future__ import annotations

import argparse
import json
import os
import sys
from typing import Any, Dict, Generic, List, Optional, Sequence, Tuple, Type, TypeVar, Union, overload

from .errors import LockstepError, LostServer, ProtocolError, Refused, SessionFailed
from .protocol import Fields, LockstepClient, Participant
from .values import Value, layout, zero

T = TypeVar("T", bool, int, float, str)


class Signal(Generic[T]):
    """An attribute that is a signal of the session; see `Input` and `Output`."""

    def __init__(self, type_name: str, initial: Optional[T] = None, name: Optional[str] = None) -> None:
        layout(type_name)  # refuses what is no type
        self.type_name = type_name
        self.initial: Value = zero(type_name) if initial is None else initial
        self._given_name = name
        self.name = name or ""

    def __set_name__(self, owner: type, attribute: str) -> None:
        self.name = self._given_name or attribute

    @overload
    def __get__(self, instance: None, owner: type) -> Signal[T]: ...

    @overload
    def __get__(self, instance: Simulation, owner: type) -> T: ...

    def __get__(self, instance: Optional[Simulation], owner: type) -> Union[Signal[T], T]:
        if instance is None:
            return self
        value: T = instance._values.get(self.name, self.initial)  # type: ignore[assignment]
        return value


class Input(Signal[T]):
    """A signal that others write: `Valve: Input[bool] = Input("BOOL")`. It cannot be assigned to."""

    def __set__(self, instance: Simulation, value: T) -> None:
        raise AttributeError(f"{self.name} is an input: another client writes it")


class Output(Signal[T]):
    """A signal that this client writes: `Level: Output[float] = Output("LREAL", 0.5)`."""

    def __set__(self, instance: Simulation, value: T) -> None:
        instance._values[self.name] = value


class Simulation(Participant):
    """Base class of a plant, a test or anything else that takes part in a session.

    A subclass declares its signals as attributes and overrides `step`, which moves it by one period, and
    `start`, if it has a state of its own: whatever `start` and `step` assign to `self` is the state. It is
    saved with a checkpoint as JSON, so it is made of numbers, texts, lists and dicts.
    """

    def __init__(self, name: str, period_ns: Optional[int] = None) -> None:
        self._name, self._period_ns = name, period_ns
        self._values: Dict[str, Value] = {}
        self._own = set(vars(self)) | {"_own", "wake_ns", "t_s", "t_ns", "dt_s"}
        self.t_s = 0.0
        self.t_ns = 0
        self.dt_s = 0.0

    def start(self) -> None:
        """Takes the initial state, also after a reset."""

    def step(self) -> None:
        """Moves it by `self.dt_s`, up to the virtual time `self.t_s`: reads inputs, assigns outputs."""

    @classmethod
    def signals(cls, kind: Type[Signal[Any]]) -> List[Signal[Any]]:
        """Its signals of one kind, in the order of their declaration, a base class's first."""
        found: Dict[str, Signal[Any]] = {}
        for owner in reversed(cls.__mro__):
            for attribute, value in vars(owner).items():
                if isinstance(value, kind):
                    found[attribute] = value
        return list(found.values())

    # ---- as a participant

    def setup(self) -> Dict[str, Value]:
        for attribute in set(vars(self)) - self._own:
            delattr(self, attribute)
        self._values = {signal.name: signal.initial for signal in self.signals(Signal)}
        self.t_s = 0.0
        self.t_ns = 0
        self.start()
        return self._outputs()

    def turn(self, t_v_ns: int, inputs: Dict[str, Value]) -> Dict[str, Value]:
        self._values.update(inputs)
        self.t_s = t_v_ns / 1e9
        self.t_ns = t_v_ns
        self.step()
        return self._outputs()

    def _outputs(self) -> Dict[str, Value]:
        return {signal.name: self._values[signal.name] for signal in self.signals(Output)}

    def save(self) -> bytes:
        own = {attribute: value for attribute, value in vars(self).items() if attribute not in self._own}
        text = json.dumps({"values": self._values, "own": own})
        if json.loads(text)["own"] != own:
            raise ValueError("the state is not made of numbers, texts, lists and dicts alone")
        return text.encode("utf-8")

    def restore(self, state: bytes) -> None:
        saved = json.loads(state.decode("utf-8"))
        if saved["values"].keys() != {signal.name for signal in self.signals(Signal)}:
            raise ValueError("it has other signals")
        self._values = saved["values"]
        for attribute, value in saved["own"].items():
            setattr(self, attribute, value)

    # ---- taking part

    def take_part(self, server: str, token: Optional[str] = None, tls_ca: Optional[str] = None,
                  tls_own: Optional[Tuple[str, str]] = None) -> Fields:
        """Takes part in the session at `HOST:PORT` to its end, and gives the fields of `end`. `token`, `tls_ca` and
        `tls_own` are those of `LockstepClient`."""
        host, port = address(server)
        with LockstepClient(host, port, token, tls_ca, tls_own) as client:
            welcome = client.connect(f"onescan-client 0.2.0 ({type(self).__name__})")
            period_ns = self._period_ns or welcome["step_ns"]
            self.dt_s = period_ns / 1e9
            listed = [[(s.name, s.type_name) for s in self.signals(kind)] for kind in (Input, Output)]
            client.join(self._name, period_ns, reads=listed[0], writes=listed[1])
            return client.run(self)

    def main(self, words: Optional[Sequence[str]] = None) -> None:
        """Takes part in the session that `--server HOST:PORT` names, and exits: 0 if it was completed or
        stopped, 2 if the server refused, 3 if the session failed or the server was lost. What it shows to the
        session is in `--token`, `--tls-ca`, `--tls-cert` and `--tls-key`, or in ONESCAN_TOKEN, ONESCAN_TLS_CA,
        ONESCAN_TLS_CERT and ONESCAN_TLS_KEY."""
        parser = argparse.ArgumentParser(description=type(self).__doc__)
        parser.add_argument("--server", required=True, metavar="HOST:PORT", help="where the session is")
        parser.add_argument("--token", default=os.environ.get("ONESCAN_TOKEN"),
                            help="the token to show (better in ONESCAN_TOKEN, where no list of processes has it)")
        parser.add_argument("--tls-ca", default=os.environ.get("ONESCAN_TLS_CA"), metavar="FILE",
                            help="speak TLS, and trust what this authority has signed")
        parser.add_argument("--tls-cert", default=os.environ.get("ONESCAN_TLS_CERT"), metavar="FILE",
                            help="show this certificate in place of a token")
        parser.add_argument("--tls-key", default=os.environ.get("ONESCAN_TLS_KEY"), metavar="FILE",
                            help="the private key of --tls-cert")
        typed = parser.parse_args(words)
        if (typed.tls_cert is None) != (typed.tls_key is None):
            parser.error("--tls-cert and --tls-key go together")
        own = (typed.tls_cert, typed.tls_key) if typed.tls_cert is not None else None
        try:
            self.take_part(typed.server, typed.token, typed.tls_ca, own)
        except Refused as error:
            print(f"refused: {error}", file=sys.stderr)
            sys.exit(2)
        except (SessionFailed, LostServer, ProtocolError) as error:
            print(f"{type(error).__name__}: {error}", file=sys.stderr)
            sys.exit(3)
        except LockstepError:
            pass  # ended before it had begun
        sys.exit(0)


def address(server: str) -> Tuple[str, int]:
    """Host and port of `HOST:PORT`."""
    host, colon, port = server.rpartition(":")
    if not colon or not port.isdigit():
        raise ValueError(f"{server!r} is no HOST:PORT")
    return host.strip("[]"), int(port)
