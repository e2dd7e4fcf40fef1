// The film in #run, and helpers of the other scripts: plane.js or space.js draws it (`drawing`), page.js plays it.
'use strict';
const run = JSON.parse(document.getElementById('run').textContent);
const root = document.documentElement;
const by = id => document.getElementById(id);
const stage = by('stage');
const last = run.times.length - 1, duration = run.times[last] || 1e-9;
const speeds = [0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 4];
let time = 0, playing = false, speed = run.speed, clockBefore = 0;

// The frame at or before a time, and the share of the way to the next.
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

function addPolyline(parent, kind, points) {
  const line = document.createElementNS('http://www.w3.org/2000/svg', 'polyline');
  line.setAttribute('class', kind);
  line.setAttribute('points', points);
  return parent.appendChild(line);
}
