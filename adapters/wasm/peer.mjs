// The engine's end of the bridge (docs/bridge.md): `node peer.mjs ENGINE` serves adapters/wasm/ENGINE.mjs.
//
// An engine's module exports `load()`, which returns a function that opens a world. A world has
//   - the commands spawn(id, brick, isMoved), remove, move, push, press, drive, turnGravity, freeze and unfreeze;
//   - watch(), if it must know before the first substep of a step that the contacts of the last are read;
//   - substep(seconds, isRead), which returns the duration [s] of the engine's own step;
//   - movers(), which returns the live and moved bodies by rising id, each an object with its `id`;
//   - writeStates(bodies, numbers, place), which writes the 13 numbers of each body's state into `numbers` from `place`;
//   - contacts, a Rows of 14 columns;
//   - close().

import { readFileSync } from "node:fs";
import { Answer, Question } from "./message.mjs";

const HELLO = 1, OPEN = 2, STEP = 3, ERROR = 4;
const COMMAND_WIDTH = 13, STATE_WIDTH = 13, CONTACT_WIDTH = 14;
const HEAD = 5; // count of numbers before the ids in the answer to a step
const NONE = new Float64Array(0);
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

const question = new Question(), answer = new Answer();

/** Play the step in `question`, write its answer from the second number of `answer`, and return the count of numbers. */
function step(world) {
  const given = question.words;
  const seconds = given[1], substeps = given[2], isRead = given[3] === 1, commands = given[4];
  for (let k = 0, place = 5; k < commands; k++, place += COMMAND_WIDTH) {
    COMMANDS[given[place]](world, given[place + 1], Array.from(given.subarray(place + 2, place + COMMAND_WIDTH)));
  }
  const bodies = world.movers(), blocks = isRead ? substeps + 1 : 1, block = bodies.length * STATE_WIDTH;
  const first = 1 + HEAD + bodies.length, end = first + blocks * block;
  answer.enlarge(end);
  let own = 0;
  if (isRead) world.watch?.();
  for (let k = 0; k < substeps; k++) {
    if (isRead) world.writeStates(bodies, answer.words, first + k * block);
    own += world.substep(seconds, isRead && k === substeps - 1);
  }
  world.writeStates(bodies, answer.words, end - block);
  const points = isRead ? world.contacts.numbers() : NONE;
  answer.enlarge(end + points.length);
  const words = answer.words;
  words.set(points, end);
  words[1] = own;
  words[2] = bodies.length;
  words[3] = blocks;
  words[4] = points.length / CONTACT_WIDTH;
  words[5] = 0;
  for (let k = 0; k < bodies.length; k++) words[1 + HEAD + k] = bodies[k].id;
  return end + points.length;
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

let world = null;
while (question.read()) {
  const { kind } = question;
  try {
    if (kind === STEP) answer.write(kind, step(world));
    else if (kind === HELLO) answer.writeText(kind, JSON.stringify(hello));
    else if (kind === OPEN) {
      world?.close();
      world = open(JSON.parse(question.text));
      answer.writeText(kind, "{}");
    } else throw new Error(`unknown message of kind ${kind}; send kind ${HELLO}, ${OPEN} or ${STEP}`);
  } catch (error) {
    answer.writeText(ERROR, JSON.stringify({ message: String(error?.message ?? error) }));
  }
}
process.exit(0);
