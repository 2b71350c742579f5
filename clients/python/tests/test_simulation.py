import struct
import unittest

from fake_server import FakeServer
from onescan_client import Input, Output, Refused, SessionFailed, Simulation
from onescan_client.simulation import address

SIZES = {"BOOL": 1, "LREAL": 8}


class Counter(Simulation):
    """Adds up while it is told to."""

    Go: Input[bool] = Input("BOOL")
    Total: Output[float] = Output("LREAL", 1.0, name="Counter.Total")

    def start(self) -> None:
        self.turns = [0]

    def step(self) -> None:
        self.turns[0] += 1
        if self.Go:
            self.Total += self.dt_s


class Simulations(unittest.TestCase):
    def test_a_session_from_joining_to_its_end(self) -> None:
        totals = []

        def session(server: FakeServer) -> None:
            server.accept(SIZES)
            server.message("setup", {})
            totals.append(server.receive()[1][24:])
            totals.append(server.grant(1, 10_000_000, b"\1"))
            totals.append(server.grant(2, 20_000_000, b"\0"))
            server.message("end", {"status": "completed", "t_v_ns": 20_000_000})

        server = FakeServer(session)
        end = Counter("plant").take_part(server.address)
        server.finish()
        self.assertEqual(end["status"], "completed")
        self.assertEqual(server.join, {"name": "plant", "period_ns": 10_000_000,
                                       "reads": [{"name": "Go", "type": "BOOL"}],
                                       "writes": [{"name": "Counter.Total", "type": "LREAL"}]})
        self.assertEqual([struct.unpack("<d", total)[0] for total in totals], [1.0, 1.01, 1.01])

    def test_an_exception_is_a_fault(self) -> None:
        class Broken(Counter):
            def step(self) -> None:
                raise ValueError("the belt is torn")

        faults = []

        def session(server: FakeServer) -> None:
            server.accept(SIZES)
            server.message("setup", {})
            server.receive()
            server.frame(b"G", struct.pack("<QQ", 1, 10_000_000) + b"\0")
            faults.append(server.receive()[1])

        server = FakeServer(session)
        with self.assertRaises(SessionFailed):
            Broken("plant").take_part(server.address)
        server.finish()
        self.assertIn(b"the belt is torn", faults[0])

    def test_a_refusal_tells_why(self) -> None:
        server = FakeServer(lambda server: server.message("refused", {"message": "no client `plnat` is expected"}))
        with self.assertRaisesRegex(Refused, "plnat"):
            Counter("plnat").take_part(server.address)
        server.finish()

    def test_a_saved_state_goes_on_to_the_bit_and_a_reset_forgets(self) -> None:
        first, second = Counter("plant"), Counter("plant")
        first.dt_s = second.dt_s = 0.1
        first.setup()
        for k in range(7):
            first.turn(k, {"Go": True})
        second.restore(first.save())
        for k in range(7, 20):
            self.assertEqual(first.turn(k, {"Go": k % 3 == 0}), second.turn(k, {"Go": k % 3 == 0}))
        self.assertEqual((first.turns, second.save()), ([20], first.save()))
        self.assertEqual(first.setup(), {"Counter.Total": 1.0})
        self.assertEqual(first.turns, [0])

    def test_a_state_that_json_would_change_is_refused(self) -> None:
        counter = Counter("plant")
        counter.setup()
        counter.turns = (1, 2)  # type: ignore[assignment]
        with self.assertRaises(ValueError):
            counter.save()
        with self.assertRaises(ValueError):
            counter.restore(b'{"values": {"Other": 1}, "own": {}}')

    def test_an_input_cannot_be_assigned_to(self) -> None:
        with self.assertRaisesRegex(AttributeError, "Go is an input"):
            Counter("plant").Go = True

    def test_addresses(self) -> None:
        self.assertEqual(address("[::1]:4840"), ("::1", 4840))
        with self.assertRaises(ValueError):
            address("localhost")


if __name__ == "__main__":
    unittest.main()
