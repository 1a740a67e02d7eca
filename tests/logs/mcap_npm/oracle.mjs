// node oracle.mjs read FILE        what Foxglove's library finds in an MCAP file, as JSON
// node oracle.mjs write FILE MODE  300 scans and poses, written by that library; MODE: unchunked, chunks, zstd, ros1
// The two directions of the comparison in tests/logs/mcap_test.cpp.
import { open, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { McapIndexedReader, McapStreamReader, McapWriter, TempBuffer } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";

const require = createRequire(import.meta.url);
const { parse } = require("@foxglove/rosmsg");
const ros1 = require("@foxglove/rosmsg-serialization");
const ros2 = require("@foxglove/rosmsg2-serialization");
const zstd = require("@foxglove/wasm-zstd");

const serializationOf = (encoding) => (encoding === "ros1" ? ros1 : ros2);

/// JSON has neither bigint nor NaN nor infinity.
const plain = (key, value) => {
  if (typeof value === "bigint") return value.toString();
  if (typeof value === "number" && !Number.isFinite(value)) return String(value);
  if (ArrayBuffer.isView(value)) return Array.from(value);
  return value;
};

async function read(path) {
  const file = await open(path);
  const { size } = await file.stat();
  const readable = {
    size: async () => BigInt(size),
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      await file.read(bytes, 0, bytes.length, Number(offset));
      return bytes;
    },
  };
  const decompressHandlers = await loadDecompressHandlers();
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const readers = new Map();
  const topics = {};
  const firsts = {};
  const logTimes = [];
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(message.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    const { MessageReader } = serializationOf(channel.messageEncoding);
    if (!readers.has(channel.id)) {
      const definition = parse(new TextDecoder().decode(schema.data), { ros2: channel.messageEncoding === "cdr" });
      readers.set(channel.id, new MessageReader(definition));
      topics[channel.topic] = {
        schema: schema.name,
        schemaEncoding: schema.encoding,
        messageEncoding: channel.messageEncoding,
        metadata: Object.fromEntries(channel.metadata),
        count: 0,
      };
      firsts[channel.topic] = readers.get(channel.id).readMessage(message.data);
    }
    readers.get(channel.id).readMessage(message.data);
    topics[channel.topic].count++;
    logTimes.push(message.logTime);
  }

  // The stream reader checks every record, the data section's check sum and the order of the records.
  const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  const whole = new Uint8Array(size);
  await file.read(whole, 0, size, 0);
  stream.append(whole);
  const records = {};
  for (let record; (record = stream.nextRecord()); ) records[record.type] = (records[record.type] ?? 0) + 1;
  await file.close();

  const increasing = logTimes.every((time, i) => i === 0 || time > logTimes[i - 1]);
  console.log(
    JSON.stringify(
      {
        header: reader.header,
        messageCount: reader.statistics.messageCount,
        chunkCount: reader.statistics.chunkCount,
        chunkIndexes: reader.chunkIndexes.length,
        compressions: [...new Set(reader.chunkIndexes.map((chunk) => chunk.compression))],
        summaryOffsets: reader.summaryOffsetsByOpcode.size,
        streamDone: stream.done(),
        increasing,
        topics,
        firsts,
        records,
      },
      plain,
    ),
  );
}

const headerDefinition = (isRos1) =>
  "=".repeat(80) +
  "\nMSG: std_msgs/Header\n" +
  (isRos1
    ? "uint32 seq\ntime stamp\nstring frame_id\n"
    : "builtin_interfaces/Time stamp\nstring frame_id\n" +
      "=".repeat(80) +
      "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n");
const scanDefinition = (isRos1) =>
  `std_msgs/Header header\nfloat32 angle_min # first beam\nfloat32 angle_max\nfloat32 angle_increment\n` +
  "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n" +
  "float32[] ranges\nfloat32[] intensities\n" +
  headerDefinition(isRos1);
const poseDefinition = (isRos1) =>
  `std_msgs/Header header\ngeometry_msgs/Pose pose\n` +
  "=".repeat(80) +
  "\nMSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n" +
  "=".repeat(80) +
  "\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" +
  "=".repeat(80) +
  "\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n" +
  headerDefinition(isRos1);

async function write(path, mode) {
  const isRos1 = mode === "ros1";
  await zstd.isLoaded;
  const writable = new TempBuffer();
  const writer = new McapWriter({
    writable,
    useChunks: mode !== "unchunked",
    chunkSize: 5000,
    compressChunk:
      mode === "zstd" ? (bytes) => ({ compression: "zstd", compressedData: zstd.compress(bytes) }) : undefined,
  });
  await writer.start({ profile: isRos1 ? "ros1" : "ros2", library: "oracle" });
  const { MessageWriter } = serializationOf(isRos1 ? "ros1" : "cdr");
  const channel = async (topic, type, definition) => {
    const name = isRos1 ? type : type.replace("/", "/msg/");
    const encoding = isRos1 ? "ros1msg" : "ros2msg";
    const schemaId = await writer.registerSchema({ name, encoding, data: new TextEncoder().encode(definition) });
    const messageEncoding = isRos1 ? "ros1" : "cdr";
    const id = await writer.registerChannel({ topic, schemaId, messageEncoding, metadata: new Map() });
    return { id, serializer: new MessageWriter(parse(definition, { ros2: !isRos1 })) };
  };
  const scans = await channel("/front/scan", "sensor_msgs/LaserScan", scanDefinition(isRos1));
  const truth = await channel("/ground_truth", "geometry_msgs/PoseStamped", poseDefinition(isRos1));
  await writer.addAttachment({
    logTime: 0n,
    createTime: 0n,
    name: "notes",
    mediaType: "text/plain",
    data: new Uint8Array(3000),
  });
  await writer.addMetadata({ name: "robot", metadata: new Map([["wheels", "2"]]) });
  const add = async ({ id, serializer }, sequence, logTime, message) =>
    await writer.addMessage({
      channelId: id,
      sequence,
      logTime,
      publishTime: logTime,
      data: serializer.writeMessage(message),
    });
  for (let i = 0; i < 300; i++) {
    const stamp = isRos1 ? { sec: 1600000000 + i, nsec: 700 } : { sec: 1600000000 + i, nanosec: 700 };
    const logTime = BigInt(1600000000 + i) * 1000000000n + 5000n;
    const ranges = Array.from({ length: 90 }, (_, k) => (k === 7 ? NaN : k === 8 ? Infinity : 0.125 * (k + 1) + i / 64));
    await add(scans, i, logTime, {
      header: { seq: i, stamp, frame_id: "laser" },
      angle_min: -1,
      angle_max: 1,
      angle_increment: 2 / 89,
      time_increment: 0,
      scan_time: 0,
      range_min: 0,
      range_max: 50,
      ranges,
      intensities: [],
    });
    await add(truth, i, logTime + 1n, {
      header: { seq: i, stamp, frame_id: "world" },
      pose: { position: { x: i / 8, y: -i, z: 0 }, orientation: { x: 0, y: 0, z: 0, w: 1 } },
    });
  }
  await writer.end();
  await writeFile(path, writable.get());
}

const [verb, path, mode] = process.argv.slice(2);
if (verb === "read") await read(path);
else if (verb === "write") await write(path, mode);
else throw new Error(`unknown verb ${verb}`);
