// The picture: bodies, joints, arrows and the pointer's spring on a canvas. In space a camera orbits.
const stage = by('stage'), pen = stage.getContext('2d');
const colour = name => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();

const rotated = ([a, b, c, d], [x, y, z]) => {
  const tx = 2 * (c * z - d * y), ty = 2 * (d * x - b * z), tz = 2 * (b * y - c * x);
  return [x + a * tx + c * tz - d * ty, y + a * ty + d * tx - b * tz, z + a * tz + b * ty - c * tx];
};
const identity = {x: [0, 0, 0], e: [1, 0, 0, 0]};
const toWorld = (place, p) => rotated(place.e, p).map((v, k) => v + place.x[k]);
const toBody = (place, p) =>
    rotated([place.e[0], -place.e[1], -place.e[2], -place.e[3]], p.map((v, k) => v - place.x[k]));

class View {
  scene = null;
  places = [];
  traces = [];
  camera = {yaw: -0.6, pitch: 0.35, zoom: 1, panX: 0, panY: 0};
  centre = [0, 0, 0];
  radius = 1;

  show(scene) {
    this.scene = scene;
    this.traces = [];  // those of the scene before name other bodies
    this.setPlaces(scene.state.bodies);
    this.local = scene.bodies.map(() => []);  // points of joints on each body
    for (const joint of scene.joints)
      for (const p of joint.parameters)
        if (p.kind === 'point' && p.body >= 0 && joint.bodies[p.body] >= 0)
          this.local[joint.bodies[p.body]].push([p.numbers[0], p.numbers[1], p.numbers[2] ?? 0]);
    for (const s of scene.springs)
      s.bodies.forEach((body, k) => body >= 0 && this.local[body].push(k ? s.to : s.from));
    this.restartTraces();
    this.fit();
  }

  restartTraces() {
    this.traces = this.scene.bodies.flatMap((body, k) => body.traces.map(local => ({body: k, local, points: []})));
  }

  setPlaces(numbers) {
    const size = this.scene.dimension === 2 ? 3 : 7;
    this.places = this.scene.bodies.map((_, k) => {
      const n = numbers.slice(size * k, size * k + size);
      return size === 3 ? {x: [n[0], n[1], 0], e: [Math.cos(n[2] / 2), 0, 0, Math.sin(n[2] / 2)]} :
                          {x: n.slice(0, 3), e: n.slice(3)};
    });
    for (const trace of this.traces) {
      trace.points.push(toWorld(this.places[trace.body], trace.local));
      if (trace.points.length > 600) trace.points.shift();
    }
  }

  place(body) { return body < 0 ? identity : this.places[body]; }

  corners(body) {
    const {shape} = this.scene.bodies[body];
    const l = shape.length / 2, w = (shape.kind === 'disc' || shape.kind === 'ball' ? shape.length : shape.width) / 2;
    const d = shape.kind === 'disc' ? shape.width / 2 : shape.kind === 'ball' ? l : (shape.depth || shape.width) / 2;
    return [[-l, -w, -d], [l, -w, -d], [l, w, -d], [-l, w, -d], [-l, -w, d], [l, -w, d], [l, w, d], [-l, w, d]];
  }

  fit() {
    const points = this.scene.bodies.flatMap(
        (_, k) => [...this.corners(k), ...this.local[k]].map(p => toWorld(this.places[k], p)));
    if (!points.length) points.push([0, 0, 0]);
    const least = [0, 1, 2].map(k => Math.min(...points.map(p => p[k])));
    const most = [0, 1, 2].map(k => Math.max(...points.map(p => p[k])));
    this.centre = least.map((v, k) => (v + most[k]) / 2);
    this.radius = Math.max(1e-6, Math.hypot(...least.map((v, k) => most[k] - v)) / 2);
    Object.assign(this.camera, {zoom: 1, panX: 0, panY: 0});
  }

  // World to picture: x, y, depth away from the eye.
  project(p) {
    const [u, v, w] = p.map((x, k) => x - this.centre[k]), scale = this.scale();
    if (this.scene.dimension === 2)
      return [this.wide / 2 + this.camera.panX + scale * u, this.high / 2 + this.camera.panY - scale * v, 0];
    const {right, up, into} = this.axes();
    const dot = a => a[0] * u + a[1] * v + a[2] * w;
    return [this.wide / 2 + this.camera.panX + scale * dot(right), this.high / 2 + this.camera.panY - scale * dot(up),
            dot(into)];
  }
  axes() {
    if (this.scene.dimension === 2) return {right: [1, 0, 0], up: [0, 1, 0], into: [0, 0, -1]};
    const {yaw, pitch} = this.camera, c = Math.cos(yaw), s = Math.sin(yaw), cp = Math.cos(pitch), sp = Math.sin(pitch);
    return {right: [c, s, 0], up: [-s * sp, c * sp, cp], into: [-s * cp, c * cp, -sp]};
  }
  scale() { return 0.36 * this.camera.zoom * Math.min(this.wide, this.high) / this.radius; }
  // Picture to world, in the plane through `at` that faces the eye.
  unproject(x, y, at) {
    const [px, py] = this.project(at), scale = this.scale(), {right, up} = this.axes();
    return at.map((v, k) => v + ((x - px) * right[k] - (y - py) * up[k]) / scale);
  }

  resize() {
    const ratio = devicePixelRatio || 1, {clientWidth, clientHeight} = stage;
    this.wide = clientWidth || 1, this.high = clientHeight || 1;
    if (stage.width !== Math.round(ratio * this.wide) || stage.height !== Math.round(ratio * this.high)) {
      stage.width = Math.round(ratio * this.wide);
      stage.height = Math.round(ratio * this.high);
    }
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  line(points, close = false) {
    pen.beginPath();
    points.forEach(([x, y], k) => k ? pen.lineTo(x, y) : pen.moveTo(x, y));
    if (close) pen.closePath();
  }

  // The outline of a body as polygons in the picture, and their depth.
  facesOf(body) {
    const {shape} = this.scene.bodies[body], place = this.places[body], on = p => this.project(toWorld(place, p));
    const ring = (r, z, n = 28) => Array.from({length: n}, (_, k) =>
        on([r * Math.cos(2 * Math.PI * k / n), r * Math.sin(2 * Math.PI * k / n), z]));
    if (shape.kind === 'none') return this.local[body].map(p => ({points: [on([0, 0, 0]), on(p)], open: true}));
    if (shape.kind === 'ball') {
      const [x, y, z] = on([0, 0, 0]), r = this.scale() * shape.length / 2;
      return [{points: Array.from({length: 28}, (_, k) =>
          [x + r * Math.cos(2 * Math.PI * k / 28), y + r * Math.sin(2 * Math.PI * k / 28), z])}];
    }
    const c = this.corners(body).map(on);
    if (this.scene.dimension === 2)
      return shape.kind === 'disc' ? [{points: ring(shape.length / 2, 0)}, {points: [on([0, 0, 0]), on([shape.length / 2, 0, 0])], open: true}] :
                                     [{points: c.slice(0, 4)}];
    if (shape.kind === 'disc')
      return [-1, 1].map(side => ({points: ring(shape.length / 2, side * shape.width / 2)}));
    return [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [2, 3, 7, 6], [1, 2, 6, 5], [0, 3, 7, 4]].map(
        face => ({points: face.map(k => c[k])}));
  }

  // `chosen`: the body that the keys pull, or -1.
  draw(marks, hand, chosen) {
    this.resize();
    pen.clearRect(0, 0, this.wide, this.high);
    if (!this.scene) return;
    const ink = {body: colour('body'), edge: colour('edge'), pin: colour('pin'), soft: colour('soft'), light: colour('light'), line: colour('line')};
    this.#ground(ink);
    pen.lineWidth = 1.5, pen.lineJoin = 'round';
    for (const trace of this.traces) {
      pen.strokeStyle = ink.soft;
      this.line(trace.points.map(p => this.project(p)));
      pen.stroke();
    }
    const faces = this.scene.bodies.flatMap((body, k) => this.facesOf(k).map(face => ({...face, fixed: body.static, chosen: k === chosen})));
    const depth = face => face.points.reduce((sum, p) => sum + p[2], 0) / face.points.length;
    if (this.scene.dimension === 3) faces.sort((a, b) => depth(b) - depth(a));
    for (const face of faces) {
      this.line(face.points, !face.open);
      pen.fillStyle = face.fixed ? ink.line : ink.body, pen.strokeStyle = face.chosen ? ink.light : ink.edge;
      pen.lineWidth = face.open ? 3 : 1.3;
      if (!face.open) pen.globalAlpha = 0.85, pen.fill(), pen.globalAlpha = 1;
      pen.stroke();
    }
    this.#joints(ink);
    if (marks) this.#marks(marks, ink);
    if (hand) this.#hand(hand, ink);
  }

  #ground(ink) {
    if (this.scene.dimension === 2) return;
    const z = this.centre[2] - this.radius, r = this.radius, [cx, cy] = this.centre;
    pen.strokeStyle = ink.line, pen.lineWidth = 1;
    for (let k = -4; k <= 4; ++k)
      for (const [a, b] of [[[k / 4, -1], [k / 4, 1]], [[-1, k / 4], [1, k / 4]]]) {
        this.line([a, b].map(([u, v]) => this.project([cx + 1.5 * r * u, cy + 1.5 * r * v, z])));
        pen.stroke();
      }
  }

  #joints(ink) {
    pen.fillStyle = ink.pin, pen.strokeStyle = ink.pin;
    for (const joint of this.scene.joints) {
      const points = joint.parameters.filter(p => p.kind === 'point').map(
          p => this.project(toWorld(this.place(p.body < 0 ? -1 : joint.bodies[p.body]), [p.numbers[0], p.numbers[1], p.numbers[2] ?? 0])));
      pen.lineWidth = 1, pen.setLineDash([3, 3]);
      if (points.length === 2) this.line(points), pen.stroke();
      pen.setLineDash([]);
      for (const [x, y] of points) pen.beginPath(), pen.arc(x, y, 3, 0, 7), pen.fill();
    }
    for (const s of this.scene.springs) this.#coil(
        this.project(toWorld(this.place(s.bodies[0]), s.from)), this.project(toWorld(this.place(s.bodies[1]), s.to)), ink.soft);
  }

  #coil([ax, ay], [bx, by], strokeStyle) {
    const length = Math.hypot(bx - ax, by - ay) || 1, nx = -(by - ay) / length, ny = (bx - ax) / length, turns = 9;
    const points = [[ax, ay]];
    for (let k = 1; k < 2 * turns; ++k) {
      const s = k / (2 * turns), side = k % 2 ? 5 : -5;
      points.push([ax + s * (bx - ax) + side * nx, ay + s * (by - ay) + side * ny]);
    }
    this.line([...points, [bx, by]]);
    pen.strokeStyle = strokeStyle, pen.lineWidth = 1.5;
    pen.stroke();
  }

  #hand({body, local, target}, ink) {
    this.#coil(this.project(toWorld(this.places[body], local)), this.project(target), ink.light);
  }

  // Arrows and points of a spec by their names.
  #marks({arrows, points, forces, lit}, ink) {
    pen.strokeStyle = pen.fillStyle = ink.light, pen.lineWidth = 2.5, pen.font = 'bold 14px system-ui, sans-serif';
    for (const {name, from, along} of [...arrows.filter(({name}) => lit.has(name)), ...this.#forceArrows(forces, lit)]) {
      const [ax, ay] = this.project(from), [bx, by] = this.project(from.map((v, k) => v + along[k]));
      const length = Math.hypot(bx - ax, by - ay) || 1, ux = (bx - ax) / length, uy = (by - ay) / length;
      this.line([[ax, ay], [bx, by]]), pen.stroke();
      this.line([[bx, by], [bx - 9 * ux + 5 * uy, by - 9 * uy - 5 * ux], [bx - 9 * ux - 5 * uy, by - 9 * uy + 5 * ux]], true);
      pen.fill();
      pen.fillText(name, (ax + bx) / 2 + 6, (ay + by) / 2 - 6);
    }
    for (const {name, at} of points) {
      if (!lit.has(name)) continue;
      const [x, y] = this.project(at);
      pen.beginPath(), pen.arc(x, y, 6, 0, 7), pen.stroke(), pen.fillText(name, x + 8, y - 8);
    }
  }

  // With C and J the forces J' lambda on the bodies; the largest is a third of the mechanism.
  #forceArrows(forces, lit) {
    if (!lit.has('C') && !lit.has('J')) return [];
    const sizes = forces.map(({force}) => Math.hypot(...force)), scale = this.radius / 3 / Math.max(...sizes, 1e-300);
    return forces.map(({from, force}, k) => ({name: `${+sizes[k].toPrecision(3)} N`, from, along: force.map(v => v * scale)}));
  }

  // The movable body at a place of the picture, and the point of it there.
  pick(x, y) {
    let best = null, nearest = 24;
    this.scene.bodies.forEach((body, k) => {
      if (body.static) return;
      const outline = [...this.facesOf(k).flatMap(face => face.open ? face.points : [])];
      const [cx, cy] = this.project(this.places[k].x);
      const inside = this.facesOf(k).some(face => {
        if (face.open) return false;
        this.line(face.points, true);
        const ratio = devicePixelRatio || 1;
        return pen.isPointInPath(x * ratio, y * ratio);
      });
      const distance = inside ? 0 : Math.min(Math.hypot(cx - x, cy - y), ...outline.map(p => Math.hypot(p[0] - x, p[1] - y)));
      if (distance <= nearest) nearest = distance, best = k;
    });
    if (best === null) return null;
    const at = this.unproject(x, y, this.places[best].x);
    return {body: best, local: toBody(this.places[best], at), target: at};
  }
}
