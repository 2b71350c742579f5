"""Opens recordings as their users do, and prints what is in them: one JSON object per folder."""

import csv
import json
import struct
import sys
from pathlib import Path

import pyarrow.dataset
from mcap.exceptions import EndOfFile
from mcap.stream_reader import StreamReader
from mcap.records import Channel, Message
from mcap_protobuf.decoder import DecoderFactory
from mcap.records import Schema


def parquet(folder):
    """Steps by pyarrow, in order and without a gap."""
    parts = folder / "trajectory"
    if not any(parts.glob("part-*.parquet")):
        return {"rows": 0}
    table = pyarrow.dataset.dataset(parts, format="parquet").to_table()
    steps = table.column("step").to_pylist()
    assert steps == list(range(len(steps))), "steps follow each other"
    last = table.slice(table.num_rows - 1).to_pylist()[0]
    return {
        "rows": table.num_rows,
        "columns": table.column_names,
        "digest": "d2:" + last["digest"].hex(),
        "last": {name: value for name, value in last.items() if name != "digest"},
    }


def mcap(path):
    """Messages of each topic, from front to back, up to where the file ends."""
    counts, schemas, channels, last = {}, {}, {}, {}
    decoders = DecoderFactory()
    with open(path, "rb") as stream:
        whole = True
        try:
            for record in StreamReader(stream).records:
                if isinstance(record, Schema):
                    schemas[record.id] = record
                elif isinstance(record, Channel):
                    channels[record.id] = record
                elif isinstance(record, Message):
                    channel = channels[record.channel_id]
                    counts[channel.topic] = counts.get(channel.topic, 0) + 1
                    last[channel.topic] = (channel, record)
        except (EndOfFile, struct.error):
            # The library reports a record that is cut in its middle by either.
            whole = False
    values = {}
    for topic, (channel, record) in last.items():
        decode = decoders.decoder_for(channel.message_encoding, schemas[channel.schema_id])
        message = decode(record.data)
        values[topic] = {field.json_name: getattr(message, field.name) for field in message.DESCRIPTOR.fields}
        values[topic]["t_v_ns"] = record.log_time
    return {"messages": counts, "whole": whole, "last": values}


def lines(path):
    """Whole rows of the CSV."""
    text = path.read_text()
    whole = text[: text.rfind("\n") + 1].splitlines()
    rows = list(csv.DictReader(whole))
    return {"rows": len(rows), "last": rows[-1] if rows else None}


for name in sys.argv[1:]:
    folder = Path(name)
    found = {"parquet": parquet(folder), "mcap": mcap(folder / "trajectory.mcap"), "csv": lines(folder / "trajectory.csv")}
    print(json.dumps(found))
