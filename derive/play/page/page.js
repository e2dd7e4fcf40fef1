// The scene: read, moved, drawn, pulled by the pointer.
async function reload() {
  const mine = ++edition;
  live = false;
  hint('reading …');
  mover.restart();
  await mover.ask({do: 'write', files: {...texts.specs, [scenePath()]: texts.scene}});
  const loaded = await mover.ask({do: 'load', path: scenePath(), ...wishes()}, 20);
  if (mine !== edition || loaded.replaced) return;
  if (loaded.problems) {
    if (shown === 'scene') showMessages(messagesIn(loaded.problems));
    hint('The text has a mistake. The picture is of the last text without one.', true);
  } else {
    if (shown === 'scene') showMessages(messagesIn(loaded.warnings));
    begin(loaded);
    live = true;
  }
  await derive();
  document.documentElement.dataset.edition = mine;
}

function begin(loaded) {
  scene = loaded, hand = grabbed = null, chosen = -1;
  hint(scene.title);
  view.show(scene);
  const before = by('joints').value, types = [...new Set(scene.joints.flatMap(typesOf))];
  by('joints').replaceChildren(...types.map(type => new Option(nameOf(type), type)));
  by('joints').value = types.includes(before) ? before : types.find(isOwn) ?? types[0] ?? '';
  showControls();
  take(scene.state);
}

function take(state) {
  if (state.problems) return state.replaced || hint(state.problems, true);
  view.setPlaces(state.bodies);
  for (const {plot, of} of plots) plot.add(state.time, of(state));
  by('cost').textContent = state.cpu > 0 ? `${(1000 * state.cpu).toPrecision(2)} ms of computing per second` : '';
  if (state.failed) hint(state.failed, true);
  Object.assign(document.documentElement.dataset, {time: state.time.toFixed(3), bodies: JSON.stringify(state.bodies), error: state.error});
}

let last = performance.now(), busy = false;
async function advance(passed) {
  busy = true;
  const mine = edition, time = stepOnce ? 1 / 60 : passed * +by('speed').value;
  stepOnce = false;
  const state = await mover.ask({do: 'step', time});
  if (mine === edition && !state.replaced) take(state);
  if (lit.size && (playing || !marks)) await findMarks();
  busy = false;
}
function frame(now) {
  const passed = Math.min(0.05, (now - last) / 1000);
  last = now;
  if (live && !busy && (playing || stepOnce)) advance(passed);
  view.draw(lit.size && marks ? {...marks, lit} : null, hand, chosen);
  for (const {plot} of plots) plot.draw();
  requestAnimationFrame(frame);
}

async function findMarks() {
  const joint = scene.joints.findIndex(one => typesOf(one).includes(by('joints').value));
  if (joint < 0) return;
  const found = await mover.ask({do: 'marks', joint});
  if (!found.problems) marks = found;
}

// --- pointer ---------------------------------------------------------------------------------

const placeOf = event => [event.offsetX, event.offsetY];
stage.addEventListener('pointerdown', event => {
  if (!scene) return;
  stage.setPointerCapture(event.pointerId);
  const [x, y] = placeOf(event);
  grabbed = view.pick(x, y);
  hand = grabbed;
  if (!grabbed) grabbed = {turn: [x, y, {...view.camera}], pan: event.shiftKey || scene.dimension === 2};
});
stage.addEventListener('pointermove', event => {
  if (!grabbed || !scene) return;
  const [x, y] = placeOf(event);
  if (grabbed.turn) {
    const [x0, y0, camera] = grabbed.turn;
    if (grabbed.pan) Object.assign(view.camera, {panX: camera.panX + x - x0, panY: camera.panY + y - y0});
    else Object.assign(view.camera, {yaw: camera.yaw - 0.01 * (x - x0), pitch: Math.max(-1.5, Math.min(1.5, camera.pitch + 0.01 * (y - y0)))});
    return;
  }
  hand.target = view.unproject(x, y, hand.target);
  if (live) mover.ask({do: 'drag', ...hand});
});
function release() {
  if (hand && live) mover.ask({do: 'drop'});
  hand = grabbed = null;
}
stage.addEventListener('pointerup', release);
stage.addEventListener('pointercancel', release);
stage.addEventListener('wheel', event => {
  event.preventDefault();
  view.camera.zoom = Math.max(0.05, Math.min(50, view.camera.zoom * Math.exp(-0.001 * event.deltaY)));
}, {passive: false});

// --- beginning -------------------------------------------------------------------------------

function open(example, ready) {
  texts = {scene: example.scene, specs: {...example.specs}};
  by('joints').replaceChildren();
  // The first picture and its derivation come with the page; the engine takes over when it has begun.
  if (ready) {
    begin(ready.scene);
    if (ready.lecture) showLecture(ready.spec, ready.lecture);
  }
  showText();
  reload();
}
by('gallery').replaceChildren(...data.gallery.map((one, k) => new Option(one.title, k)));
by('gallery').addEventListener('change', () => (shown = 'scene', open(data.gallery[+by('gallery').value])));
setDark(matchMedia('(prefers-color-scheme: dark)').matches);
const linked = fromFragment(location.hash.slice(1));
open(linked ?? data.gallery[0], linked ? null : data.first);
requestAnimationFrame(frame);

// A page that `cdot play` serves follows the files on disk: an editor of one's own changes what moves here.
async function follow(edition) {
  try {
    const answer = await (await fetch(`example?edition=${edition}`)).json();
    if (answer.problems) hint(answer.problems, true);
    else if (edition && answer.scene) open(answer);
    setTimeout(follow, 500, answer.edition);
  } catch {
    if (edition) hint('The program that serves this page has ended. The page itself goes on.');  // else it is another server
  }
}
if (location.protocol === 'http:' && location.hostname === '127.0.0.1') follow('');
