// Reads an MCAP file with the format's own reader, twice: from front to back, and by its index. Prints one JSON object
// of what is in it; throws at whatever the reader does not accept, wrong checksums too.
//
//   node read.mjs FILE FROM_NS TO_NS      messages of this time (both ends included) are counted by the index
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { decompress } from "fzstd";
import { readFileSync } from "node:fs";

const [file, from, to] = process.argv.slice(2);
const bytes = readFileSync(file);
const decompressHandlers = { zstd: (chunk, size) => decompress(chunk, new Uint8Array(Number(size))) };
const text = new TextDecoder("utf-8", { fatal: true });
const found = { schemas: {}, topics: {}, messages: {}, window: {} };

const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(bytes);
const schemas = new Map(), channels = new Map();
for (let record; (record = stream.nextRecord()); ) {
  if (record.type === "Schema") {
    schemas.set(record.id, record);
    if (record.encoding !== "jsonschema") throw new Error(`schema ${record.name} is ${record.encoding}`);
    found.schemas[record.name] = JSON.parse(text.decode(record.data));
  } else if (record.type === "Channel") {
    channels.set(record.id, record);
    if (record.messageEncoding !== "json") throw new Error(`topic ${record.topic} is ${record.messageEncoding}`);
    found.topics[record.topic] = schemas.get(record.schemaId).name;
    found.messages[record.topic] ??= [];
  } else if (record.type === "Message") {
    found.messages[channels.get(record.channelId).topic].push({
      ...JSON.parse(text.decode(record.data)), log_time_ns: String(record.logTime) });
  }
}
if (!stream.done() || stream.bytesRemaining() !== 0) throw new Error("the file does not end where it should");

const indexed = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => bytes.subarray(Number(offset), Number(offset + length)),
  },
  decompressHandlers,
});
found.chunks = indexed.chunkIndexes.length;
found.statistics = Object.fromEntries([...indexed.statistics.channelMessageCounts].map(
  ([id, count]) => [indexed.channelsById.get(id).topic, Number(count)]));
found.all = Number(indexed.statistics.messageCount);
found.begin_ns = String(indexed.statistics.messageStartTime);
found.end_ns = String(indexed.statistics.messageEndTime);
let last = 0n;
for await (const message of indexed.readMessages({ startTime: BigInt(from), endTime: BigInt(to), validateCrcs: true })) {
  if (message.logTime < last) throw new Error("messages by the index are not in the order of their times");
  last = message.logTime;
  const topic = indexed.channelsById.get(message.channelId).topic;
  found.window[topic] = (found.window[topic] ?? 0) + 1;
}
console.log(JSON.stringify(found));
