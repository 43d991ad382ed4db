// node read_mcap.mjs FILE: reads an MCAP file by its index with Foxglove's own reader, checks every checksum, decodes
// every message by the schema in the file, and says as JSON what was there.
import { open } from "node:fs/promises";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import zstd from "@foxglove/wasm-zstd";
import { decoder, differences } from "./schemas.mjs";

await zstd.isLoaded;
const decompressHandlers = { zstd: (bytes, size) => zstd.decompress(bytes, Number(size)) };
const file = await open(process.argv[2], "r");
const { size } = await file.stat();
const readable = {
  size: async () => BigInt(size),
  read: async (offset, length) => {
    const buffer = new Uint8Array(Number(length));
    await file.read(buffer, 0, buffer.length, Number(offset));
    return buffer;
  },
};

const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
const topics = {};
const wrong = [];
const decoders = new Map();
for (const channel of reader.channelsById.values()) {
  const schema = reader.schemasById.get(channel.schemaId);
  if (schema?.encoding === "protobuf") wrong.push(...differences(schema.name, schema.data));
  if (schema != undefined) decoders.set(channel.id, decoder(schema.name, schema.encoding, schema.data));
  topics[channel.topic] = { count: 0, schema: schema?.name, encoding: channel.messageEncoding };
}
let before = 0n;
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const topic = topics[reader.channelsById.get(message.channelId).topic];
  const decoded = decoders.get(message.channelId)?.(message.data);
  ++topic.count;
  if (decoded != undefined) topic.last = decoded;
  if (message.logTime < before) wrong.push(`${message.logTime} after ${before}`);
  before = message.logTime;
}

// And once more from beginning to end, without the index.
const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
let streamed = 0;
for (let offset = 0; offset < size; offset += 1 << 20) {
  stream.append(await readable.read(BigInt(offset), BigInt(Math.min(1 << 20, size - offset))));
  for (let record = stream.nextRecord(); record != undefined; record = stream.nextRecord())
    if (record.type === "Message") ++streamed;
}
if (!stream.done()) wrong.push("the file does not end where it should");
const counted = reader.statistics.messageCount;
if (BigInt(streamed) !== counted) wrong.push(`${streamed} messages, by the statistics ${counted}`);
await file.close();
const plain = (key, value) => {
  if (value instanceof Uint8Array) return { bytes: value.length };
  return typeof value === "bigint" ? Number(value) : value;
};
console.log(JSON.stringify({ topics, wrong, chunks: reader.chunkIndexes.length }, plain));
