// Draws a planar film: moves the groups of the page, which marks.cpp has drawn.

// --- places ------------------------------------------------------------------------------------

const world = [0, 0, 0];
const places = run.start.map(place => place.slice());
const groups = places.map((_, body) => [...stage.querySelectorAll(`[data-body="${body}"]`)]);
const links = [...stage.querySelectorAll('[data-link]')];

function setPlaces(frame, share) {
  const stride = 3 * run.moving.length, here = frame * stride,
        next = Math.min(frame + 1, last) * stride;
  run.moving.forEach((body, k) => {
    for (let c = 0; c < 3; ++c) {
      const a = run.poses[here + 3 * k + c], b = run.poses[next + 3 * k + c];
      places[body][c] = a + share * (b - a);
    }
  });
}

function pointOf([body, x, y], at) {
  const [px, py, degrees] = body < 0 ? world : at[body];
  const angle = degrees * Math.PI / 180, c = Math.cos(angle), s = Math.sin(angle);
  return [px + c * x - s * y, py + s * x + c * y];
}

const transform = (x, y, degrees) =>
    `translate(${x.toFixed(2)} ${y.toFixed(2)}) rotate(${degrees.toFixed(2)})`;

function linkTransform([from, to]) {
  const [x, y] = pointOf(from, places), [u, v] = pointOf(to, places);
  const degrees = Math.atan2(v - y, u - x) * 180 / Math.PI;
  return `${transform(x, y, degrees)} scale(${Math.hypot(u - x, v - y).toFixed(3)} 1)`;
}

// --- traces ------------------------------------------------------------------------------------

const paths = run.traces.map(() => []);
run.times.forEach((_, frame) => {
  const at = {};
  run.moving.forEach((body, k) => {
    const first = 3 * (frame * run.moving.length + k);
    at[body] = [run.poses[first], run.poses[first + 1], run.poses[first + 2]];
  });
  run.traces.forEach(
      (trace, k) => paths[k].push(pointOf(trace.point, at).map(v => v.toFixed(1)).join(',')));
});

const pasts = paths.map((path, k) => {
  const colour = `c${run.traces[k].colour}`;
  addPolyline(by('paths'), `trace path ${colour}`, path.join(' '));
  return addPolyline(by('paths'), `trace past ${colour}`, '');
});

// --- view --------------------------------------------------------------------------------------

const whole = stage.getAttribute('viewBox').split(' ').map(Number);
let view = whole.slice();
const setView = box => {
  view = box;
  stage.setAttribute('viewBox', view.join(' '));
};

stage.addEventListener('wheel', event => {
  event.preventDefault();
  const factor = Math.exp(0.0015 * event.deltaY),
        at = new DOMPoint(event.clientX, event.clientY)
                 .matrixTransform(stage.getScreenCTM().inverse());
  setView([
    at.x + factor * (view[0] - at.x), at.y + factor * (view[1] - at.y), factor * view[2],
    factor * view[3]
  ]);
}, {passive: false});

stage.addEventListener('pointermove', event => {
  if (!event.buttons) return;
  const scale = stage.getScreenCTM().a;
  setView([view[0] - event.movementX / scale, view[1] - event.movementY / scale, view[2], view[3]]);
});

const drawing = {
  fit: () => setView(whole.slice()),
  show(frame, share) {
    setPlaces(frame, share);
    groups.forEach(
        (list, body) =>
            list.forEach(group => group.setAttribute('transform', transform(...places[body]))));
    links.forEach(
        group => group.setAttribute('transform', linkTransform(run.links[+group.dataset.link])));
    pasts.forEach(
        (line, k) => line.setAttribute(
            'points', paths[k].slice(Math.max(0, frame - run.tail), frame + 1).join(' ')));
  },
};
