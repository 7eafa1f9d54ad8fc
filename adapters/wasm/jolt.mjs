// Jolt behind the bridge. adapters/_jolt.py describes freezing, contacts and friction.

import initJolt from "jolt-physics";
import { Rows } from "./rows.mjs";

export const packageFile = "node_modules/jolt-physics/package.json";

const STATE_WIDTH = 13;
const STATIC_LAYER = 0, MOVING_LAYER = 1;
const MAX_ANGULAR_VELOCITY = 1000; // [rad/s]; 47 as shipped, which slows down bricks that topple fast
const MAX_LINEAR_VELOCITY = 500; // [m/s], as shipped, in a world of scale 1

// Offsets of the fields of Jolt's objects, in 32-bit words; `checkLayout` compares them with the functions of the API.
const BODY = { position: 0, rotation: 4, motion: 17 };
const MOTION = { linear: 0, angular: 4 };
const MANIFOLD = { base: 0, normal: 4, count1: 12, points1: 16, count2: 272, points2: 276 };

let Jolt;

export async function load() {
  Jolt = await initJolt();
  checkLayout();
  return (opening) => new World(opening);
}

class World {
  contacts = new Rows();
  #bodies = new Map(); // by id: { id, body, handle, address, motion }
  #idAt = new Map(); // id of a body, by its address
  #movers = null;
  #forces = new Map();
  #scratch = [new Jolt.Vec3(), new Jolt.Vec3()];
  #position = new Jolt.RVec3();
  #rotation = new Jolt.Quat();

  constructor(opening) {
    this.opening = opening;
    this.knobs = Object.entries(opening.knobs);
    this.jolt = openJolt();
    this.system = this.jolt.GetPhysicsSystem();
    this.interface = this.system.GetBodyInterfaceNoLock();
    this.#configure();
    this.turnGravity(opening.gravity);
    const [x, y, z] = opening.ground_half_edges;
    this.#create(-1, { size: [2 * x, 2 * y, 2 * z], position: [0, 0, -z], quaternion: [1, 0, 0, 0] }, "Static");
    opening.fixed.forEach((box, index) => this.#create(-2 - index, box, "Static"));
    this.listener = this.#listener();
  }

  close() {
    Jolt.destroy(this.jolt);
    Jolt.destroy(this.listener);
  }

  spawn(id, brick, isMoved) {
    this.#bodies.set(id, this.#create(id, brick, isMoved ? "Kinematic" : "Dynamic"));
    this.#movers = null;
  }

  remove(id) {
    const { handle, address } = this.#bodies.get(id);
    this.interface.RemoveBody(handle);
    this.interface.DestroyBody(handle);
    this.#bodies.delete(id);
    this.#idAt.delete(address);
    this.#forces.delete(id);
    this.#movers = null;
    this.#wakeAll();
  }

  move(id, position, quaternion) {
    const { handle, body } = this.#bodies.get(id);
    this.interface.SetPositionAndRotation(handle, this.#at(position), this.#turn(quaternion), Jolt.EActivation_DontActivate);
    if (!body.IsStatic()) this.#setVelocity(body, [0, 0, 0], [0, 0, 0]);
    this.#wakeAll();
  }

  push(id, impulse) {
    const { handle } = this.#bodies.get(id);
    this.interface.AddImpulse(handle, this.#vector(impulse));
  }

  press(id, force) {
    if (force.some(Boolean)) this.#forces.set(id, force);
    else this.#forces.delete(id);
  }

  drive(id, linear, angular) {
    const { handle } = this.#bodies.get(id);
    this.interface.SetLinearAndAngularVelocity(handle, this.#vector(linear), this.#vector(angular, 1));
  }

  turnGravity(gravity) {
    this.system.SetGravity(this.#vector(gravity));
    this.#wakeAll();
  }

  freeze(id) {
    const { body, handle } = this.#bodies.get(id);
    this.#setVelocity(body, [0, 0, 0], [0, 0, 0]);
    this.interface.SetMotionType(handle, Jolt.EMotionType_Static, Jolt.EActivation_DontActivate);
    this.#movers = null;
  }

  unfreeze(id) {
    const { body, handle } = this.#bodies.get(id);
    this.interface.SetMotionType(handle, Jolt.EMotionType_Dynamic, Jolt.EActivation_Activate);
    this.#setVelocity(body, [0, 0, 0], [0, 0, 0]);
    this.#movers = null;
  }

  movers() {
    this.#movers ??= [...this.#bodies.values()].filter(({ body }) => !body.IsStatic()).sort((a, b) => a.id - b.id);
    return this.#movers;
  }

  substep(seconds, isRead) {
    for (const [id, force] of this.#forces) {
      this.interface.AddForce(this.#bodies.get(id).handle, this.#vector(force), Jolt.EActivation_Activate);
    }
    this.contacts.clear();
    this.system.SetContactListener(isRead ? this.listener : null);
    const begin = performance.now();
    this.jolt.Step(seconds, 1);
    return (performance.now() - begin) / 1e3;
  }

  writeStates(bodies, numbers, place) {
    const floats = Jolt.HEAPF32;
    for (const { address, motion } of bodies) {
      const at = address / 4 + BODY.position, turn = address / 4 + BODY.rotation;
      const linear = motion / 4 + MOTION.linear, angular = motion / 4 + MOTION.angular;
      for (let k = 0; k < 3; k++) {
        numbers[place + k] = floats[at + k];
        numbers[place + 4 + k] = floats[turn + k];
        numbers[place + 7 + k] = floats[linear + k];
        numbers[place + 10 + k] = floats[angular + k];
      }
      numbers[place + 3] = floats[turn + 3];
      place += STATE_WIDTH;
    }
  }

  /** Return the numbers of writeStates for a body from Jolt's functions, which take longer than memory. */
  saidState(id) {
    const { body } = this.#bodies.get(id);
    const p = vectorOf(body.GetPosition()), q = body.GetRotation();
    const turn = [q.GetW(), q.GetX(), q.GetY(), q.GetZ()];
    return [...p, ...turn, ...vectorOf(body.GetLinearVelocity()), ...vectorOf(body.GetAngularVelocity())];
  }

  #configure() {
    const settings = this.system.GetPhysicsSettings();
    for (const [name, value] of this.knobs) {
      if (name.startsWith("body.")) continue;
      if (!(name in settings)) throw new Error(`Jolt has no setting '${name}'; use a field of its PhysicsSettings`);
      settings[name] = value;
    }
    this.system.SetPhysicsSettings(settings);
    Jolt.destroy(settings);
  }

  #create(id, brick, kind) {
    const [x, y, z] = brick.size;
    const shape = new Jolt.BoxShape(this.#vector([x / 2, y / 2, z / 2]), 0);
    const layer = kind === "Static" ? STATIC_LAYER : MOVING_LAYER;
    const motion = Jolt[`EMotionType_${kind}`];
    const settings = new Jolt.BodyCreationSettings(
      shape, this.#at(brick.position), this.#turn(brick.quaternion), motion, layer,
    );
    settings.mFriction = this.opening.friction;
    settings.mAllowSleeping = this.opening.sleeping !== "off";
    settings.mMaxAngularVelocity = MAX_ANGULAR_VELOCITY;
    settings.mMaxLinearVelocity = MAX_LINEAR_VELOCITY * this.opening.scale;
    if (kind !== "Static") {
      settings.mOverrideMassProperties = Jolt.EOverrideMassProperties_CalculateInertia;
      settings.mMassPropertiesOverride.mMass = brick.mass;
    }
    for (const [name, value] of this.knobs) {
      if (!name.startsWith("body.")) continue;
      if (!(name.slice(5) in settings)) {
        throw new Error(`bodies of Jolt have no setting '${name.slice(5)}'; use a field of its BodyCreationSettings`);
      }
      settings[name.slice(5)] = value;
    }
    const body = this.interface.CreateBody(settings);
    Jolt.destroy(settings);
    const handle = body.GetID(), address = Jolt.getPointer(body);
    this.interface.AddBody(handle, Jolt.EActivation_Activate);
    this.#idAt.set(address, id);
    return { id, body, handle, address, motion: Jolt.HEAPU32[address / 4 + BODY.motion] };
  }

  #listener() {
    const listener = new Jolt.ContactListenerJS();
    const list = (body1, body2, manifold) => this.#list(this.#idAt.get(body1), this.#idAt.get(body2), manifold / 4);
    listener.OnContactValidate = () => Jolt.ValidateResult_AcceptAllContactsForThisBodyPair;
    listener.OnContactAdded = list;
    listener.OnContactPersisted = list;
    listener.OnContactRemoved = () => {};
    return listener;
  }

  /** Record the points of a manifold, given its address in 32-bit words. */
  #list(a, b, manifold) {
    const floats = Jolt.HEAPF32, count = Jolt.HEAPU32[manifold + MANIFOLD.count1];
    const base = manifold + MANIFOLD.base, normal = manifold + MANIFOLD.normal;
    const x = floats[base], y = floats[base + 1], z = floats[base + 2];
    for (let k = 0; k < count; k++) {
      const on1 = manifold + MANIFOLD.points1 + 4 * k, on2 = manifold + MANIFOLD.points2 + 4 * k;
      this.contacts.add(
        a, b,
        x + floats[on1], y + floats[on1 + 1], z + floats[on1 + 2],
        x + floats[on2], y + floats[on2 + 1], z + floats[on2 + 2],
        floats[normal], floats[normal + 1], floats[normal + 2],
      );
    }
  }

  /** Wake all sleeping bodies, because Jolt does not wake them when supports or gravity change. */
  #wakeAll() {
    if (this.opening.sleeping === "off") return;
    for (const { body, handle } of this.#bodies.values()) if (!body.IsStatic()) this.interface.ActivateBody(handle);
  }

  #setVelocity(body, linear, angular) {
    body.SetLinearVelocity(this.#vector(linear));
    body.SetAngularVelocity(this.#vector(angular));
  }

  #vector([x, y, z], which = 0) {
    this.#scratch[which].Set(x, y, z);
    return this.#scratch[which];
  }

  #at([x, y, z]) {
    this.#position.Set(x, y, z);
    return this.#position;
  }

  #turn([w, x, y, z]) {
    this.#rotation.Set(x, y, z, w);
    return this.#rotation;
  }
}

function openJolt() {
  const pairs = new Jolt.ObjectLayerPairFilterTable(2);
  pairs.EnableCollision(STATIC_LAYER, MOVING_LAYER);
  pairs.EnableCollision(MOVING_LAYER, MOVING_LAYER);
  const layers = new Jolt.BroadPhaseLayerInterfaceTable(2, 2);
  const settings = new Jolt.JoltSettings();
  for (const layer of [STATIC_LAYER, MOVING_LAYER]) {
    const broad = new Jolt.BroadPhaseLayer(layer);
    layers.MapObjectToBroadPhaseLayer(layer, broad);
    Jolt.destroy(broad);
  }
  settings.mObjectLayerPairFilter = pairs;
  settings.mBroadPhaseLayerInterface = layers;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 2, pairs, 2);
  const jolt = new Jolt.JoltInterface(settings);
  Jolt.destroy(settings);
  return jolt;
}

/** Compare the fields in memory with the API's functions, for two boxes that touch. */
function checkLayout() {
  const opening = { gravity: [0, 0, -1], friction: 1, scale: 1, ground_half_edges: [1, 1, 1], fixed: [], knobs: {}, sleeping: "off" };
  const world = new World(opening);
  world.spawn(0, { size: [0.3, 0.2, 0.1], mass: 1, position: [0.1, 0.2, 0.05], quaternion: [0.8, 0, 0, 0.6] }, false);
  const reported = [];
  const list = world.listener.OnContactAdded;
  world.listener.OnContactAdded = (body1, body2, address) => {
    const manifold = Jolt.wrapPointer(address, Jolt.ContactManifold), n = manifold.mWorldSpaceNormal;
    for (let k = 0; k < manifold.mRelativeContactPointsOn1.size(); k++) {
      const on1 = vectorOf(manifold.GetWorldSpaceContactPointOn1(k)), on2 = vectorOf(manifold.GetWorldSpaceContactPointOn2(k));
      reported.push(...on1, ...on2, ...vectorOf(n));
    }
    list(body1, body2, address);
  };
  world.substep(0.01, true);
  const seen = Array.from(world.contacts.numbers()).filter((_, k) => k % 14 > 1 && k % 14 < 11);
  const state = new Float64Array(STATE_WIDTH);
  world.writeStates(world.movers(), state, 0);
  const said = world.saidState(0);
  const close = (a, b) => a.length === b.length && a.every((x, k) => Math.abs(x - b[k]) < 1e-5);
  if (!reported.length || !close(reported, seen) || !close(said, Array.from(state))) {
    throw new Error(
      "Jolt's objects have another layout in memory than adapters/wasm/jolt.mjs expects; install its locked version",
    );
  }
  world.close();
}

function vectorOf(vector) {
  return [vector.GetX(), vector.GetY(), vector.GetZ()];
}
