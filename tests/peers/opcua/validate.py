"""Takes the published NodeSet2 file into an `asyncua` server, and holds its nodes against what a session serves.

    validate.py NODESET URL
"""

import asyncio
import sys

from asyncua import Client, Server, ua

TYPES = "urn:onescan:lockstep"
ROOTS = (1001, 1002, 3001, 3003)


async def described(node, uris):
    """What a node says of itself and of its references, with namespaces by name."""
    def named(id):
        return f"{uris[id.NamespaceIndex]} {id.Identifier}"

    attributes = [ua.AttributeIds.NodeClass, ua.AttributeIds.BrowseName, ua.AttributeIds.DisplayName,
                  ua.AttributeIds.Description]
    node_class, browse_name, shown, about = [
        value.Value.Value for value in await node.read_attributes(attributes)]
    said = [int(node_class), uris[browse_name.NamespaceIndex], browse_name.Name, shown.Text, about.Text or ""]
    if node_class == ua.NodeClass.Variable:
        more = [ua.AttributeIds.DataType, ua.AttributeIds.ValueRank, ua.AttributeIds.AccessLevel]
        data_type, rank, access = [value.Value.Value for value in await node.read_attributes(more)]
        said += [named(data_type), int(rank), int(access)]
        if browse_name.Name in ("InputArguments", "OutputArguments"):
            said += [(a.Name, named(a.DataType), a.ValueRank, a.Description.Text) for a in await node.read_value()]
        if browse_name.Name == "EnumStrings":
            said += [text.Text for text in await node.read_value()]
    return said


async def of_types(connection):
    uris = await connection.get_namespace_array()
    index = uris.index(TYPES)
    found = {}
    waiting = [connection.get_node(ua.NodeId(number, index)) for number in ROOTS]
    while waiting:
        node = waiting.pop()
        if node.nodeid.Identifier in found:
            continue
        references = await node.get_references(direction=ua.BrowseDirection.Both)
        links = sorted(
            (r.ReferenceTypeId.Identifier, bool(r.IsForward), uris[r.NodeId.NamespaceIndex], str(r.NodeId.Identifier))
            for r in references
            # What instances say of their types is not the types' business.
            if uris[r.NodeId.NamespaceIndex] != "urn:onescan:session"
        )
        found[node.nodeid.Identifier] = (await described(node, uris), links)
        for reference in references:
            if reference.IsForward and reference.NodeId.NamespaceIndex == index:
                waiting.append(connection.get_node(reference.NodeId))
    return found


async def main(nodeset, url):
    server = Server()
    await server.init()
    imported = await server.import_xml(nodeset)
    published = await of_types(server)
    assert len(imported) == len(published), (len(imported), len(published))
    async with Client(url) as client:
        served = await of_types(client)
        await client.load_data_type_definitions()
    for number in sorted(published.keys() | served.keys()):
        assert published.get(number) == served.get(number), (number, published.get(number), served.get(number))
    print(f"{len(served)} nodes are the same")


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
