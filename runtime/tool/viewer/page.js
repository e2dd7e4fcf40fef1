// Plays the film: plots, time, controls. `drawing` draws a frame.

// --- plots -------------------------------------------------------------------------------------

const short = value => Math.abs(value) >= 1e-3 && Math.abs(value) < 1e5 || value === 0 ?
    String(+value.toPrecision(4)) :
    value.toExponential(2);

// Multiples of 1, 2 or 5 times a power of ten within a range.
function ticksWithin(low, high, most) {
  const rough = (high - low) / most, decade = 10 ** Math.floor(Math.log10(rough));
  const step = decade * [1, 2, 5, 10].find(k => k * decade >= rough);
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) ticks.push(k * step);
  return ticks;
}

// A grid line in the plot and a label beside it, at a share of its height or width in per cent.
function addTick(figure, axis, at, text) {
  const label = document.createElement('i');
  label.textContent = text;
  label.style[axis === 'y' ? 'top' : 'left'] = `${at.toFixed(2)}%`;
  figure.querySelector(`.ticks.${axis}`).appendChild(label);
  addPolyline(figure.querySelector('.plot'), 'grid', axis === 'y' ? `0,${at} 100,${at}` : `${at},0 ${at},100`);
}

function addAxes(figure, low, high, height, unit) {
  for (const value of ticksWithin(low, high, 4)) addTick(figure, 'y', height(value), short(value));
  for (const t of ticksWithin(0, duration, 3)) addTick(figure, 't', 100 * t / duration, short(t));
  figure.querySelector('.ticks.t').lastChild.textContent += ' s';
  if (unit) figure.querySelector('figcaption span').textContent += ` [${unit}]`;
}

function plot(id, values, unit, fromZero) {
  const low = fromZero ? 0 : Math.min(...values), high = Math.max(...values),
        span = high - low || 1;
  const flat = !fromZero && high - low < 1e-9 * Math.max(1, Math.abs(high));
  // A constant lies in the middle of a range of its own size.
  const room = flat ? Math.abs(high) / 2 || 1 : 0;
  const height = v => flat ? 50 - 45 * (v - high) / room : 95 - 90 * (v - low) / span;
  addAxes(by(id).closest('figure'), low - room, high + room, height, unit);
  const points = values.map(
      (v, k) => `${(100 * run.times[k] / duration).toFixed(2)},${height(v).toFixed(2)}`);
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

function sensorPlot(sensor, k) {
  const id = `sensor${k}`;
  const figure = by('error').closest('figure').cloneNode(true);
  figure.querySelector('span').textContent = sensor.name;
  figure.querySelector('b').id = `${id}-now`;
  figure.querySelector('svg').id = id;
  figure.querySelector('.range').id = `${id}-range`;
  by('report').before(figure);
  return plot(id, sensor.values, sensor.unit === '1' ? '' : sensor.unit, false);
}

// The figures of sensors are copies of an empty one.
const plots = [
  ...run.sensors.map(sensorPlot), plot('energy', run.energy, 'J', false),
  plot('error', run.error, '', true)
];

// --- time --------------------------------------------------------------------------------------

function show(t) {
  time = Math.min(duration, Math.max(0, t));
  const [frame, share] = frameAt(time);
  drawing.show(frame, share);
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

// --- looks -------------------------------------------------------------------------------------

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
  0: () => drawing.fit(),
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
