// Messages of the bridge in memory that is reused, so that a step allocates nothing and each message is one read or write.

import { readSync, writeSync } from "node:fs";

const HEADER = 8; // bytes: length of the body, kind
const CAPACITY = 1 << 20; // bytes; that of the pipes

class Message {
  /** All numbers of the message; its header takes the place of the first. */
  words = new Float64Array(CAPACITY / 8);
  bytes = Buffer.from(this.words.buffer);

  /** Make room for a message of `count` numbers in all, and keep the numbers so far. */
  enlarge(count) {
    if (count <= this.words.length) return;
    const larger = new Float64Array(2 * count);
    larger.set(this.words);
    this.words = larger;
    this.bytes = Buffer.from(larger.buffer);
  }
}

export class Question extends Message {
  #have = 0;
  #need = 0; // length of the message that was read last

  get kind() {
    return this.bytes.readUInt32LE(4);
  }

  get text() {
    return this.bytes.toString("utf8", HEADER, this.#need);
  }

  /** Read the next message; return false at the end of stdin. */
  read() {
    this.bytes.copyWithin(0, this.#need, this.#have);
    this.#have -= this.#need;
    this.#need = HEADER;
    while (this.#have < this.#need) {
      const count = readSync(0, this.bytes, this.#have, this.bytes.length - this.#have, null);
      if (!count) return false;
      this.#have += count;
      if (this.#have >= HEADER) {
        this.#need = HEADER + this.bytes.readUInt32LE(0);
        this.enlarge(Math.ceil(this.#need / 8));
      }
    }
    return true;
  }
}

export class Answer extends Message {
  /** Write the message whose body `words` holds, up to its `count` numbers, header included. */
  write(kind, count) {
    this.#send(kind, 8 * count);
  }

  writeText(kind, text) {
    this.enlarge(1 + text.length); // no character has more than 8 bytes
    this.#send(kind, HEADER + this.bytes.write(text, HEADER));
  }

  #send(kind, length) {
    this.bytes.writeUInt32LE(length - HEADER, 0);
    this.bytes.writeUInt32LE(kind, 4);
    for (let sent = 0; sent < length; ) sent += writeSync(1, this.bytes, sent, length - sent);
  }
}
