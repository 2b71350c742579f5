import unittest

from onescan_client.streams import Line, ListeningPort, SerialPort, size
from onescan_client.values import layout, pack, unpack, zero

MS = 1_000_000
EMPTY = "00" * size(64)


class Lines(unittest.TestCase):
    def test_a_line_is_a_value_like_any_other(self) -> None:
        self.assertEqual((layout("BYTES[64]")[0].size, zero("BYTES[64]")), (100, EMPTY))
        line = Line(EMPTY, 64)
        for number in range(70):
            line.put(number)
        value = line.value()
        self.assertEqual(unpack("BYTES[64]", pack("BYTES[64]", value)), value)
        self.assertEqual((Line(value, 64).count, Line(value, 64).at(69), Line(value, 64).at(6)), (70, 69, 6))
        with self.assertRaises(ValueError):
            pack("BYTES[64]", "00")

    def test_a_byte_lasts_as_long_as_its_bits(self) -> None:
        device, plc = {}, {}
        answer, seen = EMPTY, {}
        for ms in range(1, 300):
            before = answer
            port = SerialPort(device, 64)
            port.arrive(ms * MS, EMPTY)
            if ms == 10:
                port.send(bytes(258 * [7]))
            answer = port.depart(ms * MS, EMPTY)
            reader = SerialPort(plc, 64)
            reader.arrive(ms * MS, before)
            seen[len(reader.received)] = ms
        # 268.75 ms from 10 ms on, seen in the step behind that in which the last byte was over
        self.assertEqual((max(seen), seen[257] + 1), (258, 280))
        self.assertEqual(SerialPort(plc, 64).lost, 0)

    def test_a_byte_that_was_lost_is_counted(self) -> None:
        line = Line(EMPTY, 64)
        line.put(1)
        line.put(2)
        line._lost[0] |= 1
        port = SerialPort({}, 64)
        port.arrive(MS, line.value())
        self.assertEqual((port.received, port.lost), (b"\2", 1))

    def test_a_connection_begins_and_ends(self) -> None:
        state = {}
        asked = Line(EMPTY, 64)
        asked.link = 1
        asked.put(2)
        port = ListeningPort(state, 64)
        port.arrive(MS, asked.value())
        self.assertTrue(port.is_open)
        self.assertEqual(port.take(9), b"\2")
        port.send(bytes(100))
        told = Line(port.depart(MS, asked.value()), 64)
        self.assertEqual((told.link, told.count, told.acknowledged), (1, 64, 1))
        asked.acknowledged = 64
        port.arrive(2 * MS, asked.value())
        self.assertEqual(Line(port.depart(2 * MS, asked.value()), 64).count, 100)
        asked.link = 2
        port.arrive(3 * MS, asked.value())
        told = Line(port.depart(3 * MS, asked.value()), 64)
        self.assertEqual((told.link, port.is_open), (2, False))


if __name__ == "__main__":
    unittest.main()
