import unittest

from onescan_client.errors import ProtocolError
from onescan_client.values import layout, pack, unpack, zero


class Values(unittest.TestCase):
    def test_every_type_goes_there_and_back(self) -> None:
        cases = [("BOOL", True), ("SINT", -128), ("UINT", 65535), ("DINT", -5), ("ULINT", 2**64 - 1), ("TIME", -1),
                 ("REAL", 0.5), ("LREAL", 0.1), ("STRING[4]", "äbc"), ("WSTRING[2]", "日本"), ("CHAR", 65)]
        for type_name, value in cases:
            data = pack(type_name, value)
            self.assertEqual((len(data), unpack(type_name, data)), (layout(type_name)[0].size, value), type_name)

    def test_values_that_are_none_are_refused(self) -> None:
        for type_name, value in [("BOOL", 2), ("SINT", 128), ("STRING[2]", "abc"), ("STRING[2]", 1), ("INT", 0.5)]:
            with self.assertRaises(ValueError, msg=type_name):
                pack(type_name, value)
        with self.assertRaises(ValueError):
            layout("BOOLEAN")
        with self.assertRaises(ProtocolError):
            unpack("BOOL", b"\2")
        with self.assertRaises(ProtocolError):
            unpack("STRING[2]", b"\3\0ab")

    def test_what_nobody_wrote_is_zero(self) -> None:
        self.assertEqual([zero(t) for t in ("BOOL", "INT", "LREAL", "STRING[3]")], [False, 0, 0.0, ""])


if __name__ == "__main__":
    unittest.main()
