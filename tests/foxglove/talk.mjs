// node talk.mjs URL SUBPROTOCOL TOPIC...: Foxglove's own client subscribes to the topics, waits for a message of each,
// and says as JSON what came.
import { createRequire } from "node:module";
import { decoder, differences } from "./schemas.mjs";
const require = createRequire(import.meta.url);
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { WebSocket } = require("ws");

const [url, subprotocol, ...wanted] = process.argv.slice(2);
const socket = new WebSocket(url, [subprotocol]);
const client = new FoxgloveClient({ ws: socket });
const result = { topics: {}, wrong: [], statuses: [] };
const subscriptions = new Map();
const finish = (status) => {
  result.protocol = socket.protocol;
  const plain = (key, value) => (value instanceof Uint8Array ? { bytes: value.length } : value);
  console.log(JSON.stringify(result, plain));
  process.exit(status);
};
setTimeout(() => finish(1), 60_000);
client.on("error", (error) => (result.wrong.push(String(error)), finish(1)));
client.on("close", () => finish(1));
client.on("serverInfo", (info) => (result.serverInfo = info));
client.on("status", (status) => result.statuses.push(status.message));
client.on("advertise", (channels) => {
  for (const channel of channels) {
    if (!wanted.includes(channel.topic)) continue;
    const schema = channel.schemaEncoding === "protobuf" ? Buffer.from(channel.schema, "base64") : channel.schema;
    if (channel.schemaEncoding === "protobuf") result.wrong.push(...differences(channel.schemaName, schema));
    const decode = decoder(channel.schemaName, channel.schemaEncoding, schema);
    subscriptions.set(client.subscribe(channel.id), { topic: channel.topic, decode });
  }
});
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const { topic, decode } = subscriptions.get(subscriptionId);
  const seen = (result.topics[topic] ??= { count: 0 });
  ++seen.count;
  seen.last = decode(new Uint8Array(data.buffer, data.byteOffset, data.byteLength));
  seen.seconds = Number(timestamp / 1_000_000_000n);
  if (wanted.every((name) => result.topics[name] != undefined)) finish(0);
});
