// The engine's end of the bridge (docs/bridge.md): `node peer.mjs ENGINE` serves adapters/wasm/ENGINE.mjs.
//
// An engine's module exports `load()`, which returns a function that opens a world. A world has
//   - the commands spawn(id, brick, isMoved), remove, move, push, press, drive, turnGravity, freeze and unfreeze;
//   - substep(seconds, isRead), which returns the duration [s] of the engine's own step;
//   - movers(), which returns the ids of live and moved bodies, in rising order;
//   - writeState(id, numbers, place), which writes the 13 numbers of a body's state into `numbers` from index `place`;
//   - contacts, a Rows of 14 columns;
//   - close().

import { readFileSync, readSync, writeSync } from "node:fs";

const HELLO = 1, OPEN = 2, STEP = 3, ERROR = 4;
const COMMAND_WIDTH = 13, STATE_WIDTH = 13, CONTACT_WIDTH = 14;
const HEAD = 5;
const COMMANDS = [
  null,
  (world, id, words) => world.spawn(id, brickOf(words), false),
  (world, id, words) => world.spawn(id, brickOf(words), true),
  (world, id) => world.remove(id),
  (world, id, words) => world.move(id, words.slice(0, 3), words.slice(3, 7)),
  (world, id, words) => world.push(id, words.slice(0, 3)),
  (world, id, words) => world.press(id, words.slice(0, 3)),
  (world, id, words) => world.drive(id, words.slice(0, 3), words.slice(3, 6)),
  (world, _, words) => world.turnGravity(words.slice(0, 3)),
  (world, id) => world.freeze(id),
  (world, id) => world.unfreeze(id),
];

function brickOf(words) {
  return { size: words.slice(0, 3), mass: words[3], position: words.slice(4, 7), quaternion: words.slice(7, 11) };
}

/** Read exactly `length` bytes; return null at the end of stdin. */
function read(bytes, length) {
  for (let have = 0; have < length; ) {
    const count = readSync(0, bytes, have, length - have, null);
    if (!count) return null;
    have += count;
  }
  return bytes;
}

function write(bytes) {
  for (let sent = 0; sent < bytes.length; ) sent += writeSync(1, bytes, sent, bytes.length - sent);
}

function answer(kind, body) {
  const message = Buffer.allocUnsafe(8 + body.byteLength);
  message.writeUInt32LE(body.byteLength, 0);
  message.writeUInt32LE(kind, 4);
  message.set(new Uint8Array(body.buffer, body.byteOffset, body.byteLength), 8);
  write(message);
}

/** Buffer of the answer to a step, reused for every step. */
let reply = new Float64Array(1 << 12);

function withRoom(length) {
  if (length > reply.length) {
    const larger = new Float64Array(2 * length);
    larger.set(reply);
    reply = larger;
  }
  return reply;
}

function step(world, words) {
  const [seconds, substeps, isRead, commands] = words;
  for (let k = 0; k < commands; k++) {
    const command = words.subarray(4 + COMMAND_WIDTH * k, 4 + COMMAND_WIDTH * (k + 1));
    COMMANDS[command[0]](world, command[1], Array.from(command.subarray(2)));
  }
  const ids = world.movers();
  const blocks = isRead ? substeps + 1 : 1;
  const end = HEAD + ids.length + blocks * ids.length * STATE_WIDTH;
  let place = withRoom(end).length && HEAD + ids.length;
  const record = () => {
    for (const id of ids) {
      world.writeState(id, reply, place);
      place += STATE_WIDTH;
    }
  };
  let own = 0;
  for (let k = 0; k < substeps; k++) {
    if (isRead) record();
    own += world.substep(seconds, isRead && k === substeps - 1);
  }
  record();
  const points = isRead ? world.contacts.numbers() : [];
  withRoom(end + points.length).set(points, end);
  reply.set([own, ids.length, blocks, points.length / CONTACT_WIDTH, 0, ...ids]);
  return reply.subarray(0, end + points.length);
}

console.log = console.info = console.debug = console.error; // because engines print to stdout, which carries the protocol

process.on("uncaughtException", (error) => {
  console.error(`${error?.stack}\n${error}`); // the suite reports the last line in the trial's message
  process.exit(1);
});

const name = process.argv[2];
const folder = new URL(".", import.meta.url);
const { load, packageFile } = await import(new URL(`${name}.mjs`, folder));
const open = await load();
const hello = JSON.parse(readFileSync(new URL(`${name}.json`, folder), "utf8"));
hello.version = JSON.parse(readFileSync(new URL(packageFile, folder), "utf8")).version;

const header = Buffer.alloc(8);
let world = null;
while (read(header, 8)) {
  const length = header.readUInt32LE(0), kind = header.readUInt32LE(4);
  const body = read(new Uint8Array(length), length);
  if (body === null) break;
  try {
    if (kind === HELLO) answer(kind, Buffer.from(JSON.stringify(hello)));
    else if (kind === OPEN) {
      world?.close();
      world = open(JSON.parse(Buffer.from(body).toString()));
      answer(kind, Buffer.from("{}"));
    } else if (kind === STEP) answer(kind, step(world, new Float64Array(body.buffer)));
    else throw new Error(`unknown message of kind ${kind}; send kind ${HELLO}, ${OPEN} or ${STEP}`);
  } catch (error) {
    answer(ERROR, Buffer.from(JSON.stringify({ message: String(error?.message ?? error) })));
  }
}
process.exit(0);
