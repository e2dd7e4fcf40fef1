// Plays the film in #run: moves the groups that the page came with. No drawing is decided here.
'use strict';
const run = JSON.parse(document.getElementById('run').textContent);
const root = document.documentElement;
const by = id => document.getElementById(id);
const stage = by('stage');
const last = run.times.length - 1, duration = run.times[last] || 1e-9;
const speeds = [0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 4];
let time = 0, playing = false, speed = run.speed, clockBefore = 0;

// --- places ------------------------------------------------------------------------------------

const world = [0, 0, 0];
const places = run.start.map(place => place.slice());
const groups = places.map((_, body) => [...stage.querySelectorAll(`[data-body="${body}"]`)]);
const links = [...stage.querySelectorAll('[data-link]')];

// The frame at or before a time, and how far the time is towards the next.
function frameAt(t) {
  let low = 0, high = last;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (run.times[middle] <= t)
      low = middle;
    else
      high = middle - 1;
  }
  const span = low < last ? run.times[low + 1] - run.times[low] : 1;
  return [low, low < last ? Math.min(1, Math.max(0, (t - run.times[low]) / span)) : 0];
}

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

function addPolyline(parent, kind, points) {
  const line = document.createElementNS('http://www.w3.org/2000/svg', 'polyline');
  line.setAttribute('class', kind);
  line.setAttribute('points', points);
  return parent.appendChild(line);
}

const pasts = paths.map((path, k) => {
  const colour = `c${run.traces[k].colour}`;
  addPolyline(by('paths'), `trace path ${colour}`, path.join(' '));
  return addPolyline(by('paths'), `trace past ${colour}`, '');
});

// --- plots -------------------------------------------------------------------------------------

const short = value => Math.abs(value) >= 1e-3 && Math.abs(value) < 1e5 || value === 0 ?
    String(+value.toPrecision(4)) :
    value.toExponential(2);

function plot(id, values, unit, fromZero) {
  const low = fromZero ? 0 : Math.min(...values), high = Math.max(...values),
        span = high - low || 1;
  const flat = !fromZero && high - low < 1e-9 * Math.max(1, Math.abs(high));
  const points = values.map(
      (v, k) => `${(100 * run.times[k] / duration).toFixed(2)},${
          flat ? 50 : (95 - 90 * (v - low) / span).toFixed(2)}`);
  addPolyline(by(id), '', points.join(' '));
  const cursor = document.createElementNS('http://www.w3.org/2000/svg', 'line');
  cursor.setAttribute('y2', 100);
  by(id).appendChild(cursor);
  by(`${id}-range`).textContent =
      fromZero ? `at most ${short(high)}` : `${short(low)} … ${short(high)} ${unit}`;
  const seek = event => {
    const box = by(id).getBoundingClientRect();
    show(duration * Math.min(1, Math.max(0, (event.clientX - box.left) / box.width)));
  };
  by(id).addEventListener('pointerdown', event => {
    pause();
    seek(event);
  });
  by(id).addEventListener('pointermove', event => {
    if (event.buttons) seek(event);
  });
  return frame => {
    const x = (100 * time / duration).toFixed(2);
    cursor.setAttribute('x1', x);
    cursor.setAttribute('x2', x);
    by(`${id}-now`).textContent = `${short(values[frame])} ${unit}`;
  };
}

const plots = [plot('energy', run.energy, 'J', false), plot('error', run.error, '', true)];

// --- time --------------------------------------------------------------------------------------

function show(t) {
  time = Math.min(duration, Math.max(0, t));
  const [frame, share] = frameAt(time);
  setPlaces(frame, share);
  groups.forEach(
      (list, body) =>
          list.forEach(group => group.setAttribute('transform', transform(...places[body]))));
  links.forEach(
      group => group.setAttribute('transform', linkTransform(run.links[+group.dataset.link])));
  pasts.forEach(
      (line, k) => line.setAttribute(
          'points', paths[k].slice(Math.max(0, frame - run.tail), frame + 1).join(' ')));
  plots.forEach(update => update(frame));
  by('scrub').value = duration > 0 ? time / duration : 0;
  by('clock').textContent = `${time.toFixed(run.decimals)} / ${duration.toFixed(run.decimals)} s`;
  root.dataset.time = time;
}

function play() {
  if (time >= duration) show(0);
  playing = true;
  clockBefore = performance.now();
  by('play').textContent = 'Pause';
  requestAnimationFrame(tick);
}

function pause() {
  playing = false;
  by('play').textContent = 'Play';
}

function tick(now) {
  if (!playing) return;
  show(time + speed * Math.max(0, now - clockBefore) / 1000);
  clockBefore = now;
  if (time >= duration) show(0);
  requestAnimationFrame(tick);
}

function stepFrames(count) {
  pause();
  const [frame] = frameAt(time);
  show(run.times[Math.min(last, Math.max(0, frame + count))]);
}

function setSpeed(value) {
  speed = value;
  by('speed').value = value;
}

function changeSpeed(direction) {
  const here = speeds.indexOf(speed);
  setSpeed(speeds[Math.min(speeds.length - 1, Math.max(0, here + direction))]);
}

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

function setDark(dark) {
  root.classList.toggle('dark', dark);
  by('theme').textContent = dark ? 'Light' : 'Dark';
}

function toggleTraces() {
  const hidden = stage.classList.toggle('plain');
  by('traces').setAttribute('aria-pressed', String(!hidden));
}

// --- controls ----------------------------------------------------------------------------------

speeds.forEach(value => by('speed').add(new Option(`${value} ×`, value)));
by('play').addEventListener('click', () => playing ? pause() : play());
by('scrub').addEventListener('input', () => {
  pause();
  show(+by('scrub').value * duration);
});
by('speed').addEventListener('change', () => setSpeed(+by('speed').value));
by('traces').addEventListener('click', toggleTraces);
by('theme').addEventListener('click', () => setDark(!root.classList.contains('dark')));

const keys = {
  ' ': () => playing ? pause() : play(),
  ArrowLeft: event => stepFrames(event.shiftKey ? -20 : -1),
  ArrowRight: event => stepFrames(event.shiftKey ? 20 : 1),
  Home: () => {
    pause();
    show(0);
  },
  End: () => {
    pause();
    show(duration);
  },
  '+': () => changeSpeed(1),
  '-': () => changeSpeed(-1),
  t: toggleTraces,
  d: () => setDark(!root.classList.contains('dark')),
  0: () => setView(whole.slice()),
};
document.addEventListener('keydown', event => {
  if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  keys[event.key](event);
});

// page.html#t=1.5 opens paused at 1.5 s.
const wanted = /t=([0-9.]+)/.exec(location.hash);
setDark(matchMedia('(prefers-color-scheme: dark)').matches);
setSpeed(speed);
show(wanted ? +wanted[1] : 0);
if (!wanted) play();
root.dataset.ready = run.times.length;
