// Draws a film in space: faces, lines and points of bodies through a camera that orbits. space_still.cpp does the same
// through the camera of the start.

// --- places ------------------------------------------------------------------------------------

const marks = run.space;
const fixed = {x: [0, 0, 0], A: [1, 0, 0, 0, 1, 0, 0, 0, 1]};

// x, y, z, e0, e1, e2, e3 to a place: the rotation matrix row by row.
function placeOf([x, y, z, a, b, c, d]) {
  const n = Math.hypot(a, b, c, d) || 1;
  a /= n, b /= n, c /= n, d /= n;
  return {
    x: [x, y, z],
    A: [
      1 - 2 * (c * c + d * d), 2 * (b * c - a * d), 2 * (b * d + a * c),
      2 * (b * c + a * d), 1 - 2 * (b * b + d * d), 2 * (c * d - a * b),
      2 * (b * d - a * c), 2 * (c * d + a * b), 1 - 2 * (b * b + c * c)
    ]
  };
}

const turned = (A, [x, y, z]) => [
  A[0] * x + A[1] * y + A[2] * z, A[3] * x + A[4] * y + A[5] * z, A[6] * x + A[7] * y + A[8] * z
];
const placed = (place, p) => turned(place.A, p).map((v, k) => v + place.x[k]);

const numbersAt = (frame, k) => {
  const first = 7 * (frame * run.moving.length + k);
  return run.poses.slice(first, first + 7);
};
const places = run.start.map(placeOf);
const placeAt = (frame, body) => run.moving.includes(body) ?
    placeOf(numbersAt(frame, run.moving.indexOf(body))) :
    places[body];

// Between two frames the quaternion is interpolated linearly, the shorter way, and normalised.
function setPlaces(frame, share) {
  const next = Math.min(frame + 1, last);
  run.moving.forEach((body, k) => {
    const a = numbersAt(frame, k), b = numbersAt(next, k);
    const sign = a[3] * b[3] + a[4] * b[4] + a[5] * b[5] + a[6] * b[6] < 0 ? -1 : 1;
    places[body] = placeOf(a.map((v, i) => v + share * ((i > 2 ? sign : 1) * b[i] - v)));
  });
}
const anchor = ([body, x, y, z]) => placed(body < 0 ? fixed : places[body], [x, y, z]);

// --- camera ------------------------------------------------------------------------------------

const start = marks.camera;
let camera = {...start};
const [wide, high] = stage.getAttribute('viewBox').split(' ').slice(2).map(Number);

// World to picture: X, Y and the depth, which grows away from the eye.
function project([x, y, z]) {
  const [cx, cy, cz] = marks.centre, u = x - cx, v = y - cy, w = z - cz;
  const c = Math.cos(camera.yaw), s = Math.sin(camera.yaw);
  const cp = Math.cos(camera.pitch), sp = Math.sin(camera.pitch);
  const right = c * u + s * v, into = -s * u + c * v;
  const up = cp * w + sp * into, depth = cp * into - sp * w;
  const scale = camera.zoom * 0.42 * Math.min(wide, high) / marks.radius /
      (1 + 0.2 * Math.max(-4, depth / marks.radius));
  return [wide / 2 + scale * right, high / 2 - scale * up, depth, scale];
}
const pathOf = (points, close) =>
    'M' + points.map(p => `${p[0].toFixed(1)} ${p[1].toFixed(1)}`).join('L') + (close ? 'Z' : '');

// --- drawing -----------------------------------------------------------------------------------

const space = by('space');
const pool = [];
function element(k) {
  if (!pool[k])
    pool[k] = space.appendChild(document.createElementNS('http://www.w3.org/2000/svg', 'path'));
  return pool[k];
}

const circle = ([x, y], r) =>
    `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0Z`;
const mean = points => points.reduce((sum, p) => sum + p[2], 0) / points.length;

// Only faces towards the eye are drawn, brighter the more they face it.
function addFace(items, body, points) {
  const seen = points.map(p => project(placed(places[body], p)));
  let area = 0, size = 0;
  seen.forEach((p, k) => {
    const q = seen[(k + 1) % seen.length];
    area += p[0] * q[1] - p[1] * q[0];
    size += Math.hypot(q[0] - p[0], q[1] - p[1]);
  });
  if (area >= 0) return;
  const shade = Math.min(1, -area / (size * size) * 8);
  items.push({depth: mean(seen), d: pathOf(seen, true), kind: marks.bodies[body].kind,
              opacity: 0.25 + 0.5 * shade, body});
}

function addBody(items, body) {
  const look = marks.bodies[body];
  look.faces.forEach(face => addFace(items, body, face));
  if (look.ball) {
    const at = project(places[body].x);
    items.push({depth: at[2], d: circle(at, Math.max(3, at[3] * look.ball)), kind: look.kind,
                opacity: 0.45, body});
  }
  look.lines.forEach(line => {
    const seen = line.map(p => project(placed(places[body], p)));
    items.push({depth: mean(seen), d: pathOf(seen), kind: `${look.kind} line`, opacity: 0, body});
  });
}

function gather() {
  const items = [];
  marks.bodies.forEach((_, body) => addBody(items, body));
  marks.links.forEach(([a, b, kind]) => {
    const seen = [project(anchor(a)), project(anchor(b))];
    items.push({depth: mean(seen), d: pathOf(seen), kind, opacity: 0});
  });
  marks.pins.forEach(pin => {
    const at = project(anchor(pin));
    items.push({depth: at[2] - 1e-3 * marks.radius, d: circle(at, 5), kind: 'pin', opacity: 1});
  });
  return items.sort((a, b) => b.depth - a.depth);
}

const tracePoints = marks.traces.map(({point: [body, ...p]}) =>
    run.times.map((_, frame) => placed(placeAt(frame, body), p)));
const traceLines = marks.traces.map(
    ({colour}) =>
        ['path', 'past'].map(kind => addPolyline(by('paths'), `trace ${kind} ${colour}`, '')));
const listed = points =>
    points.map(p => project(p).slice(0, 2).map(v => v.toFixed(1)).join(',')).join(' ');

const drawing = {
  frame: 0,
  share: 0,
  show(frame, share) {
    this.frame = frame, this.share = share;
    setPlaces(frame, share);
    this.paint();
  },
  paint() {
    const items = gather();
    items.forEach((item, k) => {
      const path = element(k);
      path.setAttribute('d', item.d);
      path.setAttribute('class', `body ${item.kind}`);
      path.style.fillOpacity = item.opacity;
      if (item.body === undefined)
        path.removeAttribute('data-body');
      else
        path.dataset.body = item.body;
    });
    for (let k = items.length; k < pool.length; ++k) pool[k].setAttribute('d', '');
    by('floor').setAttribute(
        'd', marks.floor.map(line => pathOf(line.map(project))).join(''));
    tracePoints.forEach((points, k) => {
      traceLines[k][0].setAttribute('points', listed(points));
      traceLines[k][1].setAttribute(
          'points', listed(points.slice(Math.max(0, this.frame - run.tail), this.frame + 1)));
    });
    root.dataset.camera =
        [camera.yaw, camera.pitch, camera.zoom].map(value => value.toFixed(3)).join(' ');
  },
  fit() {
    camera = {...start};
    this.paint();
  },
};

stage.addEventListener('wheel', event => {
  event.preventDefault();
  camera.zoom *= Math.exp(-0.0015 * event.deltaY);
  drawing.paint();
}, {passive: false});

stage.addEventListener('pointermove', event => {
  if (!event.buttons) return;
  camera.yaw -= 0.008 * event.movementX;
  camera.pitch = Math.min(1.57, Math.max(-1.57, camera.pitch + 0.008 * event.movementY));
  drawing.paint();
});

