// How the messages of a channel are read by its own schema, and what Foxglove's published schemas say of it.
import { createRequire } from "node:module";
const require = createRequire(import.meta.url);
const protobuf = require("protobufjs");
const descriptor = require("protobufjs/ext/descriptor");
const published = require("@foxglove/schemas/internal");

/** A function from bytes to an object. */
export function decoder(name, encoding, schema) {
  if (encoding === "jsonschema") return (bytes) => JSON.parse(new TextDecoder().decode(bytes));
  if (encoding !== "protobuf") return undefined;
  const type = rootOf(schema).lookupType(name);
  return (bytes) => type.toObject(type.decode(bytes), { longs: Number, enums: String, bytes: (b) => b });
}

/** What differs between the embedded schema and the published one, a line each; fields that we leave out do not. */
export function differences(name, schema) {
  const ours = rootOf(schema);
  const lines = [];
  const seen = new Set();
  compare(name.replace("foxglove.", ""));
  return lines;

  function compare(type) {
    if (seen.has(type)) return;
    seen.add(type);
    const known = published.foxgloveMessageSchemas[type];
    if (known == undefined) return void lines.push(`${type} is not published`);
    const enums = Object.values(published.foxgloveEnumSchemas).filter((e) => e.parentSchemaName === type);
    const text = published.generateProto(known, enums).replace(/import "foxglove[^;]*;/g, "");
    const theirs = protobuf.parse(text, { keepCase: true }).root.lookupType(`foxglove.${type}`);
    for (const field of ours.lookupType(`foxglove.${type}`).fieldsArray) {
      const other = theirs.fields[field.name];
      const last = (word) => word.split(".").pop();
      if (other == undefined) lines.push(`${type}.${field.name} is not published`);
      else if (other.id !== field.id || last(other.type) !== last(field.type) || other.repeated !== field.repeated)
        lines.push(`${type}.${field.name}: ${other.type} = ${other.id}, here ${field.type} = ${field.id}`);
      const inner = last(field.type);
      if (field.resolve().resolvedType instanceof protobuf.Type && field.type.startsWith(".foxglove")) compare(inner);
      if (field.resolvedType instanceof protobuf.Enum && other != undefined) {
        const values = theirs.get(inner)?.values;
        const ours = field.resolvedType.values;
        if (JSON.stringify(values) !== JSON.stringify(ours)) lines.push(`${type}.${inner}: values`);
      }
    }
  }
}

function rootOf(schema) {
  const root = protobuf.Root.fromDescriptor(descriptor.FileDescriptorSet.decode(schema));
  root.resolveAll();
  return root;
}
