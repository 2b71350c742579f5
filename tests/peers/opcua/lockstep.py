"""A client of a onescan session with nothing but an OPC UA client (docs/opcua.md), written from scratch on `asyncua`.

Who takes part has `setup()` and `turn(t_v_ns, inputs)`, which give outputs by name.
"""

import asyncio

from asyncua import Client, ua

START, SETUP, READY, READ, RUN, WRITE, ENDED = range(7)


class Place:
    """The nodes of one client, found by browsing."""

    def __init__(self, client, name):
        self.client, self.name = client, name

    async def find(self):
        index = await self.client.get_namespace_index("urn:onescan:session")
        types = await self.client.get_namespace_index("urn:onescan:lockstep")
        objects = self.client.nodes.objects
        self.session = await objects.get_child(f"{index}:Session")
        self.node = await self.session.get_child([f"{types}:Clients", f"{index}:{self.name}"])
        for member in ("State", "Period", "Start", "Grant", "GrantTime", "Wake", "Done", "Fault", "Turn"):
            setattr(self, member, await self.node.get_child(f"{types}:{member}"))
        self.end = await self.session.get_child(f"{types}:End")
        self.inputs = await self._signals(types, index, "Input")
        self.outputs = await self._signals(types, index, "Output")
        return self

    async def _signals(self, types, index, kind):
        folder = await self.node.get_child(f"{types}:{kind}s")
        names = await (await self.node.get_child(f"{types}:{kind}Order")).read_value()
        nodes = [await folder.get_child(f"{index}:{name}") for name in names]
        assert {node.nodeid for node in nodes} == {node.nodeid for node in await folder.get_children()}
        kinds = [await node.read_data_type_as_variant_type() for node in nodes]
        return list(zip(names, nodes, kinds))

    def packed(self, outputs):
        return [ua.Variant(outputs[name], kind) for name, _, kind in self.outputs]

    async def write(self, nodes, values):
        """One Write; the status of each value by its name."""
        statuses = await self.client.write_values(nodes, values, raise_on_partial_error=False)
        return [status.name for status in statuses]

    async def done(self, grant):
        return (await self.write([self.Done], [ua.Variant(grant, ua.VariantType.UInt64)]))[0]

    async def start(self):
        assert await self.write([self.Start], [True]) == ["Good"]


def answer(who, t_v_ns, inputs):
    return who.setup() if t_v_ns == 0 else who.turn(t_v_ns, inputs)


async def by_variables(place, who, subscribed=False):
    """Reads, runs, writes outputs and Done in one Write. New grants are seen by polling or reported by a subscription."""
    changed = asyncio.Event()

    class Handler:
        def datachange_notification(self, node, value, data):
            changed.set()

        def status_change_notification(self, status):
            changed.set()

    if subscribed:
        subscription = await place.client.create_subscription(1, Handler())
        await subscription.subscribe_data_change([place.Grant, place.State])
    await place.start()
    nodes = [place.State, place.Grant, place.GrantTime] + [node for _, node, _ in place.inputs]
    last = 0
    while True:
        changed.clear()
        state, grant, t_v_ns, *inputs = await place.client.read_values(nodes)
        if state == ENDED:
            return
        if grant == last:
            await (asyncio.wait_for(changed.wait(), 10) if subscribed else asyncio.sleep(0))
            continue
        last = grant
        outputs = answer(who, t_v_ns, dict(zip((name for name, _, _ in place.inputs), inputs)))
        where = [node for _, node, _ in place.outputs] + [place.Done]
        what = place.packed(outputs) + [ua.Variant(grant, ua.VariantType.UInt64)]
        statuses = await place.write(where, what)
        assert all(status == "Good" for status in statuses), statuses


async def by_method(place, who):
    """One call a step."""
    done, outputs = 0, []
    while True:
        arguments = [
            ua.Variant(done, ua.VariantType.UInt64),
            ua.Variant(0, ua.VariantType.Int64),
            ua.Variant(outputs, ua.VariantType.Variant, is_array=True),
            ua.Variant(2000, ua.VariantType.UInt32),
        ]
        state, grant, t_v_ns, inputs = await place.node.call_method(place.Turn, *arguments)
        if state == ENDED:
            return
        if state not in (SETUP, RUN):
            done, outputs = 0, []
            continue
        given = {name: value.Value for (name, _, _), value in zip(place.inputs, inputs)}
        done, outputs = grant, place.packed(answer(who, t_v_ns, given))


def connected(url):
    return Client(url, timeout=120)
