// Havok behind the bridge. adapters/_havok.py describes freezing, contacts and friction.

import { readFileSync } from "node:fs";
import initHavok from "@babylonjs/havok";
import { Rows } from "./rows.mjs";

export const packageFile = "node_modules/@babylonjs/havok/package.json";

const WASM = new URL("node_modules/@babylonjs/havok/lib/esm/HavokPhysics.wasm", import.meta.url);
const SPEED_LIMITS = [500, 1000]; // [m/s], [rad/s]; 200 units/s as shipped, which slows a slide in a world of scale 100
const STATE_WIDTH = 13;
const STILL = [0, 0, 0];
const KNOBS = ["shape", "idealStepTime", "angularDamping"];

// Offsets of the fields of a collision event, in 32-bit words; `checkLayout` compares them with HP_Event_AsCollision.
const EVENT = { bodyA: 2, pointA: 10, normal: 13, bodyB: 18, pointB: 26 };

let hk;
let scratch; // address of a state in memory; functions whose names begin with "_" write to an address, and return 0

export async function load() {
  hk = await initHavok({ wasmBinary: readFileSync(WASM) });
  scratch = hk._malloc(4 * STATE_WIDTH);
  checkLayout();
  return (opening) => new World(opening);
}

/** Return the value of an API function's [result, value]; throw an error if the result is not OK. */
function done(answer) {
  const [result, value] = Array.isArray(answer) ? answer : [answer];
  if (result !== hk.Result.RESULT_OK) throw new Error(`Havok must return RESULT_OK, got result ${result.value ?? result}; check the knobs of the profile and the values of the bricks`);
  return value;
}

class World {
  contacts = new Rows();
  #bodies = new Map(); // by id: { id, handle, shape, mass, number, kind }
  #idAt = new Map(); // id of a body, by the number of its handle
  #movers = null;
  #forces = new Map();
  #isWatched = false;

  constructor(opening) {
    for (const name in opening.knobs) {
      if (!KNOBS.includes(name)) throw new Error(`Havok has no setting '${name}'; use one of: ${KNOBS.join(", ")}`);
    }
    this.opening = opening;
    this.knobs = opening.knobs;
    this.world = done(hk.HP_World_Create());
    const [linear, angular] = SPEED_LIMITS;
    done(hk.HP_World_SetSpeedLimit(this.world, linear * opening.scale, angular));
    if ("idealStepTime" in this.knobs) done(hk.HP_World_SetIdealStepTime(this.world, this.knobs.idealStepTime));
    this.turnGravity(opening.gravity);
    const [x, y, z] = opening.ground_half_edges;
    this.#create(-1, { size: [2 * x, 2 * y, 2 * z], position: [0, 0, -z], quaternion: [1, 0, 0, 0], mass: 1 }, "STATIC");
    opening.fixed.forEach((box, index) => this.#create(-2 - index, { ...box, mass: 1 }, "STATIC"));
  }

  close() {
    for (const body of this.#bodies.values()) this.#release(body);
    done(hk.HP_World_Release(this.world));
  }

  spawn(id, brick, isMoved) {
    this.#create(id, brick, isMoved ? "KINEMATIC" : "DYNAMIC");
    this.#movers = null;
  }

  remove(id) {
    const body = this.#bodies.get(id);
    this.#bodies.delete(id);
    this.#idAt.delete(body.number);
    this.#forces.delete(id);
    this.#movers = null;
    this.#release(body);
    this.#wakeAll();
  }

  move(id, position, quaternion) {
    const body = this.#bodies.get(id);
    done(hk.HP_Body_SetQTransform(body.handle, transform(position, quaternion)));
    if (body.kind !== "STATIC") this.#setVelocity(body, STILL, STILL);
    this.#wakeAll();
  }

  push(id, impulse) {
    const { handle } = this.#bodies.get(id);
    done(hk.HP_Body_ApplyImpulse(handle, done(hk.HP_Body_GetPosition(handle)), impulse));
  }

  press(id, force) {
    if (force.some(Boolean)) this.#forces.set(id, force);
    else this.#forces.delete(id);
  }

  drive(id, linear, angular) {
    this.#setVelocity(this.#bodies.get(id), linear, angular);
  }

  turnGravity(gravity) {
    done(hk.HP_World_SetGravity(this.world, gravity));
    this.#wakeAll();
  }

  freeze(id) {
    const body = this.#bodies.get(id);
    this.#setVelocity(body, STILL, STILL);
    this.#setKind(body, "STATIC");
  }

  unfreeze(id) {
    const body = this.#bodies.get(id);
    this.#setKind(body, "DYNAMIC");
    done(hk.HP_Body_SetMassProperties(body.handle, body.mass));
    this.#keepActive(body);
    this.#setVelocity(body, STILL, STILL);
    done(hk.HP_Body_SetActivationState(body.handle, hk.ActivationState.ACTIVE));
  }

  movers() {
    this.#movers ??= [...this.#bodies.values()]
      .filter(({ id, kind }) => id >= 0 && kind !== "STATIC")
      .sort((a, b) => a.id - b.id);
    return this.#movers;
  }

  substep(seconds, isRead) {
    for (const [id, force] of this.#forces) this.push(id, force.map((x) => x * seconds));
    this.contacts.clear();
    const begin = performance.now();
    done(hk.HP_World_Step(this.world, seconds));
    const own = (performance.now() - begin) / 1e3;
    if (isRead) this.#readEvents();
    return own;
  }

  writeStates(bodies, numbers, place) {
    for (const { handle } of bodies) {
      const [pointer] = handle, linear = scratch + 4 * 7, angular = linear + 4 * 3;
      if (
        hk._HP_Body_GetQTransform(pointer, scratch) || hk._HP_Body_GetLinearVelocity(pointer, linear) ||
        hk._HP_Body_GetAngularVelocity(pointer, angular)
      ) throw new Error("Havok does not return the state of a body; install its locked version");
      const floats = hk.HEAPF32, from = scratch / 4;
      for (let k = 0; k < STATE_WIDTH; k++) numbers[place + k] = floats[from + k];
      numbers[place + 3] = floats[from + 6]; // w comes last in Havok, and first in the protocol
      for (let k = 4; k < 7; k++) numbers[place + k] = floats[from + k - 1];
      place += STATE_WIDTH;
    }
  }

  /** Return the numbers of writeStates for a body from the functions of the API, which take 100 times as long. */
  saidState(id) {
    const { handle } = this.#bodies.get(id);
    const [position, [x, y, z, w]] = done(hk.HP_Body_GetQTransform(handle));
    return [...position, w, x, y, z, ...done(hk.HP_Body_GetLinearVelocity(handle)), ...done(hk.HP_Body_GetAngularVelocity(handle))];
  }

  /** Record the events of the latest step. All events share one place in memory, and each can be read once. */
  #readEvents() {
    const world = Number(this.world[0]), words = hk.HEAPU32, floats = hk.HEAPF32;
    let numberA, numberB, a, b; // the points of a pair follow one another, so that few ids are looked up
    let [, event] = hk.HP_World_GetCollisionEvents(this.world); // the result is a failure if there are no events
    while (event) {
      const at = event / 4, on1 = at + EVENT.pointA, on2 = at + EVENT.pointB, n = at + EVENT.normal;
      if (words[at + EVENT.bodyA] !== numberA) a = this.#idAt.get((numberA = words[at + EVENT.bodyA]));
      if (words[at + EVENT.bodyB] !== numberB) b = this.#idAt.get((numberB = words[at + EVENT.bodyB]));
      this.contacts.add(
        a, b,
        floats[on1], floats[on1 + 1], floats[on1 + 2],
        floats[on2], floats[on2 + 1], floats[on2 + 2],
        floats[n], floats[n + 1], floats[n + 2],
      );
      this.onEvent?.(event);
      event = hk.HP_World_GetNextCollisionEvent(world, event);
    }
  }

  /** Return the numbers of a contact point from Havok's function, which takes much longer than memory. */
  said(event) {
    const [, a, b] = done(hk.HP_Event_AsCollision(event));
    return [this.#idAt.get(Number(a[0][0])), this.#idAt.get(Number(b[0][0])), ...a[3], ...b[3], ...a[4]];
  }

  /**
   * Make all bodies report their contacts from now on. Havok then makes existing contacts anew, and the first substep of
   * a contact has no friction: therefore a step is watched from its first substep on, in which no contact exists yet.
   */
  watch() {
    if (this.#isWatched) return;
    this.#isWatched = true;
    for (const [id, { handle }] of this.#bodies) if (id >= 0) this.#report(handle);
  }

  #report(handle) {
    const { COLLISION_STARTED, COLLISION_CONTINUED } = hk.EventType;
    done(hk.HP_Body_SetEventMask(handle, COLLISION_STARTED.value | COLLISION_CONTINUED.value));
  }

  #create(id, brick, kind) {
    const shape = this.#shapeOf(brick.size), handle = done(hk.HP_Body_Create());
    const { friction } = this.opening, { GEOMETRIC_MEAN, MINIMUM } = hk.MaterialCombine;
    done(hk.HP_Shape_SetMaterial(shape, [friction, friction, 0, GEOMETRIC_MEAN, MINIMUM]));
    done(hk.HP_Body_SetShape(handle, shape));
    const squares = brick.size.map((edge) => (edge * edge) / 12), sum = squares[0] + squares[1] + squares[2];
    const mass = [STILL, brick.mass, squares.map((square) => sum - square), [0, 0, 0, 1]]; // inertia for a mass of 1
    const body = { id, handle, shape, mass, number: Number(handle[0]), kind };
    this.#bodies.set(id, body);
    this.#idAt.set(body.number, id);
    this.#setKind(body, kind);
    done(hk.HP_Body_SetMassProperties(handle, mass));
    done(hk.HP_Body_SetQTransform(handle, transform(brick.position, brick.quaternion)));
    if ("angularDamping" in this.knobs) done(hk.HP_Body_SetAngularDamping(handle, this.knobs.angularDamping));
    done(hk.HP_World_AddBody(this.world, handle, false));
    this.#keepActive(body);
    if (this.#isWatched && id >= 0) this.#report(handle);
  }

  #shapeOf([x, y, z]) {
    if (this.knobs.shape !== "hull") return done(hk.HP_Shape_CreateBox(STILL, [0, 0, 0, 1], [x, y, z]));
    const memory = hk._malloc(8 * 3 * 4);
    for (let k = 0; k < 8; k++) {
      const corner = [k & 1 ? x : -x, k & 2 ? y : -y, k & 4 ? z : -z].map((edge) => edge / 2);
      hk.HEAPF32.set(corner, memory / 4 + 3 * k);
    }
    const shape = done(hk.HP_Shape_CreateConvexHull(memory, 8));
    hk._free(memory);
    return shape;
  }

  #release({ handle, shape }) {
    done(hk.HP_World_RemoveBody(this.world, handle));
    done(hk.HP_Body_Release(handle));
    done(hk.HP_Shape_Release(shape));
  }

  #setKind(body, kind) {
    body.kind = kind;
    this.#movers = null;
    done(hk.HP_Body_SetMotionType(body.handle, hk.MotionType[kind]));
  }

  #keepActive({ handle, kind }) {
    if (this.opening.sleeping === "off" && kind !== "STATIC") {
      done(hk.HP_Body_SetActivationControl(handle, hk.ActivationControl.ALWAYS_ACTIVE));
    }
  }

  /** Wake all sleeping bodies. */
  #wakeAll() {
    if (this.opening.sleeping === "off") return;
    for (const { handle, kind } of this.#bodies.values()) {
      if (kind !== "STATIC") done(hk.HP_Body_SetActivationState(handle, hk.ActivationState.ACTIVE));
    }
  }

  #setVelocity({ handle }, linear, angular) {
    done(hk.HP_Body_SetLinearVelocity(handle, linear));
    done(hk.HP_Body_SetAngularVelocity(handle, angular));
  }
}

function transform(position, [w, x, y, z]) {
  return [position, [x, y, z, w]];
}

/** Compare the events and the state in memory with the API's functions, for two boxes that touch. */
function checkLayout() {
  const opening = { gravity: [0, 0, -1], friction: 1, scale: 1, ground_half_edges: [1, 1, 1], fixed: [], knobs: {}, sleeping: "off" };
  const world = new World(opening);
  world.spawn(0, { size: [0.3, 0.2, 0.1], mass: 1, position: [0.1, 0.2, 0.05], quaternion: [0.8, 0, 0, 0.6] }, false);
  const said = [];
  world.onEvent = (event) => said.push(...world.said(event));
  world.watch();
  world.substep(0.01, true);
  const seen = Array.from(world.contacts.numbers()).filter((_, k) => k % 14 < 11);
  const state = new Float64Array(STATE_WIDTH);
  world.writeStates(world.movers(), state, 0);
  const agree = (a, b) => a.length === b.length && a.every((x, k) => Math.abs(x - b[k]) < 1e-6);
  if (!said.length || !agree(said, seen) || !agree(world.saidState(0), Array.from(state))) {
    throw new Error(
      "Havok's events or states have another layout in memory than adapters/wasm/havok.mjs expects; install its locked version",
    );
  }
  world.close();
}
