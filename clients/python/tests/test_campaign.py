import io
import tarfile
import tempfile
import unittest
from pathlib import Path

from onescan_client import CampaignFailed, campaign
from onescan_client.campaign import _pack, _unpack


class Campaigns(unittest.TestCase):
    def test_folders_travel_as_bytes(self) -> None:
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place) / "scenario"
            (folder / "plc").mkdir(parents=True)
            (folder / "scenario.toml").write_text("version = 1\n")
            (folder / "plc" / "main.st").write_bytes(bytes(range(256)))
            there = _unpack(_pack(folder), Path(place) / "there")
            self.assertEqual((there / "plc" / "main.st").read_bytes(), bytes(range(256)))
            only = _unpack(_pack(folder, only="main.st"), Path(place) / "only")
            self.assertEqual([path.name for path in only.rglob("*") if path.is_file()], ["main.st"])

    def test_nothing_is_written_elsewhere(self) -> None:
        packed = io.BytesIO()
        with tarfile.open(fileobj=packed, mode="w:gz") as archive:
            archive.addfile(tarfile.TarInfo("../elsewhere"), io.BytesIO())
        with tempfile.TemporaryDirectory() as place, self.assertRaises(CampaignFailed):
            _unpack(packed.getvalue(), Path(place) / "there")

    def test_what_the_program_says_is_told(self) -> None:
        with self.assertRaisesRegex(CampaignFailed, "cannot be started"):
            campaign("scenario", program="./no-such-program")


if __name__ == "__main__":
    unittest.main()
