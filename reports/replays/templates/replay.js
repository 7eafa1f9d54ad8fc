"use strict";
(async () => {
  const COLUMNS = 10, [BODY, FRAME, X, Y, Z, QW, QX, QY, QZ, STATE] = Array(COLUMNS).keys();
  const LIVE = new THREE.Color("#e0a030"), FROZEN = new THREE.Color("#5b9fc9"), FALLEN = new THREE.Color("#a8425a");
  const FIXED = "#969a9e", NO_MARGIN = new THREE.Color(FIXED);
  const MARGINS = JSON.parse(document.getElementById("margin-colours").textContent).map(text => new THREE.Color(text));

  // Restore columns of numbers from deflated differences, which are grouped by byte.
  const unpack = async (text, rows) => {
    const packed = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer()), count = rows * COLUMNS;
    return Array.from({ length: COLUMNS }, (_, column) => {
      const values = new Int32Array(rows);
      for (let row = 0, sum = 0; row < rows; row++) {
        const at = column * rows + row;
        sum += bytes[at] | bytes[at + count] << 8 | bytes[at + 2 * count] << 16 | bytes[at + 3 * count] << 24;
        values[row] = sum;
      }
      return values;
    });
  };

  // The rows of each body, of which the first gives its initial position: a body far from it has fallen.
  const bodiesOf = (trial, columns) => {
    const bodies = [];
    for (let begin = 0, end; begin < trial.rows; begin = end) {
      for (end = begin; end < trial.rows && columns[BODY][end] === columns[BODY][begin];) end++;
      const name = columns[BODY][begin], size = trial.sizes[name];
      bodies.push({ name, begin, end, size, thickness: Math.min(...size), tint: 1 + .07 * Math.sin(12.9898 * bodies.length) });
    }
    return bodies;
  };

  // The geometry of a shape that is no box, from the corners of its triangles.
  const surfaceOf = triangles => {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(triangles.flat(), 3));
    geometry.computeVertexNormals();
    return geometry;
  };

  const trials = JSON.parse(document.getElementById("trials").textContent);
  const panels = [...document.querySelectorAll(".panel")];
  const clock = document.getElementById("clock"), slider = document.getElementById("time");
  const shade = document.getElementById("colour");
  const play = document.getElementById("play"), speed = document.getElementById("speed");
  const camera = { turn: -1.2, lift: .3, distance: 1, target: new THREE.Vector3() };
  const shared = new THREE.PerspectiveCamera(30, 1, .01, 100);
  shared.up.set(0, 0, 1);

  for (const trial of trials) {
    trial.columns = await unpack(trial.data, trial.rows);
    trial.bodies = bodiesOf(trial, trial.columns);
    trial.end_s = trial.frames * trial.frame_s;
  }
  const end = Math.max(...trials.map(trial => trial.end_s));
  slider.max = end;

  const views = trials.map((trial, index) => {
    let renderer;
    try {
      renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
    } catch {
      panels[index].querySelector("p").append(" This browser shows no 3-D (WebGL).");
      return null;
    }
    renderer.shadowMap.enabled = true;
    renderer.shadowMap.type = THREE.PCFSoftShadowMap;
    renderer.outputEncoding = THREE.sRGBEncoding;
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    panels[index].append(renderer.domElement);
    const scene = new THREE.Scene(), sun = new THREE.DirectionalLight("#fff6e8", .75);
    scene.add(new THREE.HemisphereLight("#ffffff", "#b9b3a6", .55), sun, sun.target);
    sun.castShadow = true;
    sun.shadow.mapSize.set(2048, 2048);
    sun.shadow.bias = -5e-4;
    const ground = new THREE.Mesh(new THREE.PlaneGeometry(20, 20), new THREE.ShadowMaterial({ opacity: .22 }));
    ground.receiveShadow = true;
    const box = new THREE.BoxGeometry(1, 1, 1);
    scene.add(ground);
    const meshOf = (geometry, count) => {
      const mesh = new THREE.InstancedMesh(geometry, new THREE.MeshStandardMaterial({ roughness: .8 }), count);
      mesh.castShadow = mesh.receiveShadow = true;
      mesh.frustumCulled = false;
      scene.add(mesh);
      return mesh;
    };
    // Boxes are instances of one mesh; a brick of another shape has a mesh of its own, in metres.
    const boxes = meshOf(box, trial.bodies.length), meshes = [boxes];
    const slots = trial.bodies.map(({ name, size }, index) => {
      if (!(name in trial.surfaces)) return { mesh: boxes, at: index, scale: size };
      const mesh = meshOf(surfaceOf(trial.surfaces[name]), 1);
      meshes.push(mesh);
      boxes.setMatrixAt(index, new THREE.Matrix4().makeScale(0, 0, 0));
      return { mesh, at: 0, scale: [1, 1, 1] };
    });
    trial.fixed.forEach(({ size, position, quaternion: [w, x, y, z] }, index) => {
      const surface = trial.surfaces[`fixed ${index}`], material = new THREE.MeshStandardMaterial({ color: FIXED, roughness: .9 });
      const still = new THREE.Mesh(surface ? surfaceOf(surface) : box, material);
      still.position.set(...position);
      still.quaternion.set(x, y, z, w);
      if (!surface) still.scale.set(...size);
      still.castShadow = still.receiveShadow = true;
      scene.add(still);
    });
    return { trial, renderer, scene, sun, slots, meshes, cursors: trial.bodies.map(body => body.begin) };
  }).filter(view => view);

  // The visible space: every brick at its initial position, and the fixed boxes.
  const span = new THREE.Box3();
  for (const { fixed } of trials)
    for (const { size, position } of fixed)
      span.union(new THREE.Box3().setFromCenterAndSize(new THREE.Vector3(...position), new THREE.Vector3(...size)));
  for (const { columns, bodies, steps } of trials)
    for (const { begin, size } of bodies)
      span.union(new THREE.Box3().setFromCenterAndSize(
        new THREE.Vector3(...[X, Y, Z].map(axis => columns[axis][begin] * steps[0])), new THREE.Vector3(...size)));
  span.getCenter(camera.target);
  const radius = span.getSize(new THREE.Vector3()).length() / 2;
  camera.distance = 1.05 * radius / Math.sin(Math.PI / 12); // shows the visible space in a field of view of 30 degrees
  for (const { sun } of views) {
    sun.position.copy(camera.target).add(new THREE.Vector3(-.5, -.9, 1.6).multiplyScalar(3 * radius));
    sun.target.position.copy(camera.target);
    Object.assign(sun.shadow.camera, { left: -2 * radius, right: 2 * radius, top: 2 * radius, bottom: -2 * radius, near: .01, far: 12 * radius });
    sun.shadow.radius = 3;
  }

  const place = new THREE.Vector3(), turned = new THREE.Quaternion(), next = new THREE.Quaternion();
  const scaled = new THREE.Vector3(), matrix = new THREE.Matrix4(), colour = new THREE.Color(), NOWHERE = new THREE.Matrix4().makeScale(0, 0, 0);
  // The class of each brick's margin, at the first instant from this time on; null if colours show states.
  const classesAt = ({ margins }, seconds) => {
    if (!margins || shade.value === "state") return null;
    const next = margins.times.findIndex(instant => instant >= seconds - 1e-9);
    return margins[shade.value][next < 0 ? margins.times.length - 1 : next];
  };
  const pose = (view, frame) => {
    const { trial, slots, meshes, cursors } = view, { columns, steps } = trial;
    const classes = classesAt(trial, frame * trial.frame_s);
    trial.bodies.forEach((body, index) => {
      let row = cursors[index];
      if (columns[FRAME][row] > frame) row = body.begin;
      while (row + 1 < body.end && columns[FRAME][row + 1] <= frame) row++;
      cursors[index] = row;
      const { mesh, at, scale } = slots[index];
      if (columns[FRAME][row] > frame || trial.states[columns[STATE][row]] === "removed") {
        mesh.setMatrixAt(at, NOWHERE);
        return;
      }
      place.set(columns[X][row], columns[Y][row], columns[Z][row]).multiplyScalar(steps[0]);
      turned.set(columns[QX][row], columns[QY][row], columns[QZ][row], columns[QW][row]).normalize();
      const after = row + 1;
      if (after < body.end && columns[FRAME][after] - columns[FRAME][row] <= trial.every) { // interpolate between neighbouring frames
        const share = (frame - columns[FRAME][row]) / (columns[FRAME][after] - columns[FRAME][row]);
        place.lerp(new THREE.Vector3(columns[X][after], columns[Y][after], columns[Z][after]).multiplyScalar(steps[0]), share);
        turned.slerp(next.set(columns[QX][after], columns[QY][after], columns[QZ][after], columns[QW][after]).normalize(), share);
      }
      const first = body.begin;
      const moved = Math.hypot(...[X, Y, Z].map((axis, at) => columns[axis][first] * steps[0] - place.getComponent(at)));
      const state = trial.states[columns[STATE][row]];
      const byState = moved > body.thickness ? FALLEN : state === "frozen" ? FROZEN : LIVE;
      colour.copy(classes ? MARGINS[classes[index]] ?? NO_MARGIN : byState).multiplyScalar(body.tint);
      mesh.setMatrixAt(at, matrix.compose(place, turned, scaled.set(...scale)));
      mesh.setColorAt(at, colour.convertSRGBToLinear());
    });
    for (const mesh of meshes) {
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
    }
  };

  let time = 0, playing = false, last = 0, waiting = false;
  const draw = now => {
    waiting = false;
    if (playing) {
      time = Math.min(end, time + Math.min((now - last) / 1e3, .1) * +speed.value);
      last = now;
      if (time >= end) setPlaying(false);
    }
    const flat = Math.cos(camera.lift);
    shared.position.set(Math.cos(camera.turn) * flat, Math.sin(camera.turn) * flat, Math.sin(camera.lift))
      .multiplyScalar(camera.distance).add(camera.target);
    shared.lookAt(camera.target);
    for (const view of views) {
      const { width, height } = view.renderer.domElement.parentElement.getBoundingClientRect();
      view.renderer.setSize(width, height);
      shared.aspect = width / height;
      shared.fov = width < height ? 30 * height / width : 30; // a narrow panel shows the same width
      shared.updateProjectionMatrix();
      pose(view, Math.min(time / view.trial.frame_s, view.trial.frames - 1));
      view.renderer.render(view.scene, shared);
    }
    slider.value = time;
    clock.textContent = `${time.toFixed(1)} of ${end.toFixed(1)} s`;
    document.body.dataset.time = time;
    if (playing) request();
  };
  const request = () => {
    if (!waiting) requestAnimationFrame(draw);
    waiting = true;
  };
  const setPlaying = on => {
    if (on && time >= end) time = 0;
    playing = on;
    last = performance.now();
    play.textContent = on ? "Pause" : "Play";
    play.setAttribute("aria-pressed", on);
    request();
  };
  const seek = to => { time = Math.max(0, Math.min(end, to)); request(); };

  play.addEventListener("click", () => setPlaying(!playing));
  slider.addEventListener("input", () => seek(+slider.value));
  shade?.addEventListener("change", () => {
    for (const key of document.querySelectorAll("[data-key]")) key.hidden = key.dataset.key !== shade.value;
    request();
  });
  addEventListener("resize", request);
  addEventListener("keydown", event => {
    if (["BUTTON", "SELECT", "INPUT"].includes(event.target.tagName)) return;
    if (event.key === " ") { setPlaying(!playing); event.preventDefault(); }
    if (event.key === "ArrowRight") seek(time + trials[0].frame_s);
    if (event.key === "ArrowLeft") seek(time - trials[0].frame_s);
  });
  const fingers = new Map();
  const spread = () => {
    const [one, other] = [...fingers.values()];
    return Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
  };
  for (const { renderer: { domElement } } of views) {
    domElement.addEventListener("pointerdown", event => {
      domElement.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, event);
    });
    domElement.addEventListener("pointermove", event => {
      const before = fingers.get(event.pointerId);
      if (!before) return;
      const apart = fingers.size === 2 ? spread() : 0;
      fingers.set(event.pointerId, event);
      if (fingers.size === 2) camera.distance *= apart / spread();
      else {
        camera.turn -= (event.clientX - before.clientX) * .008;
        camera.lift = Math.max(.02, Math.min(1.5, camera.lift + (event.clientY - before.clientY) * .008));
      }
      request();
    });
    for (const ending of ["pointerup", "pointercancel"])
      domElement.addEventListener(ending, event => fingers.delete(event.pointerId));
    domElement.addEventListener("wheel", event => {
      camera.distance *= Math.exp(event.deltaY * .001);
      event.preventDefault();
      request();
    }, { passive: false });
  }
  seek(end); // begin with the final state, as in a still
})();
