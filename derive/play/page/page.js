// The page: what a person types and drags becomes requests to two engines. One reads and derives, one moves.
const reader = new Engine(), mover = new Engine();
const view = new View();
let texts = {scene: '', specs: {}};  // specs: own ones, by their file
let shown = 'scene', scene = null, playing = true, hand = null, grabbed = null, marks = null, plots = [], busy = false;
let edition = 0, stepOnce = false;

const own = name => `${folderOf(texts.scene)}${name}`;
const scenePath = () => own('scene.toml');
const hint = (text, wrong = false) => {
  by('hint').textContent = text;
  by('hint').className = wrong ? 'wrong' : '';
};

// --- the texts -------------------------------------------------------------------------------

// The file of the spec that the panel shows: that of the chosen joint.
const specFile = () => own(by('joints').value.replace(/#\d+$/, '') || 'revolute') + '.joint';
const specText = () => texts.specs[specFile()] ?? data.files[specFile()] ?? data.files[specFile().replace('.joint', '.effect')] ?? '';

function showText() {
  editor.value = shown === 'scene' ? texts.scene : specText();
  by('tab-scene').setAttribute('aria-selected', shown === 'scene');
  by('tab-spec').setAttribute('aria-selected', shown === 'spec');
  showMessages([]);
}

// A copy of a joint of the catalogue gets a name of its own, in its header and in the scene.
function adopt(text) {
  const file = specFile(), name = by('joints').value;
  if (!data.files[file] || texts.specs[file]) return [file, text];
  const mine = `my_${name}`;
  texts.scene = texts.scene.replaceAll(`"${name}"`, `"${mine}"`);
  const option = [...by('joints').options].find(one => one.value === name);
  option.value = option.textContent = mine;
  return [specFile(), text.replace(new RegExp(`^(\\s*joint\\s+)${name}\\b`, 'm'), `$1${mine}`)];
}

let waiting = 0;
editor.addEventListener('input', () => {
  if (shown === 'scene') {
    texts.scene = editor.value;
  } else {
    const [file, text] = adopt(editor.value);
    texts.specs[file] = text;
    if (text !== editor.value) {
      const at = editor.selectionStart + text.length - editor.value.length;
      editor.value = text;
      editor.setSelectionRange(at, at);
    }
  }
  clearTimeout(waiting);
  waiting = setTimeout(reload, 250);
});

// --- derivation ------------------------------------------------------------------------------

let derived = '';
async function derive() {
  const path = specFile().replace(/\.joint$/, data.files[specFile().replace('.joint', '.effect')] ? '.effect' : '.joint');
  const text = texts.specs[path] ?? data.files[path];
  if (!text) return true;
  await reader.ask({do: 'write', files: texts.specs});
  const checked = await reader.ask({do: 'check', path});
  if (shown === 'spec') showMessages(checked.messages ?? messagesIn(checked.problems ?? ''));
  if ((checked.messages ?? [{severity: 'error'}]).some(m => m.severity === 'error')) {
    by('lecture').classList.add('stale');
    return false;
  }
  if (derived === path + text) return true;
  const {title, html, problems, replaced} = await reader.ask({do: 'explain', path}, 20);
  if (replaced) return true;
  if (problems) {
    if (shown === 'spec') showMessages(messagesIn(problems));
    return false;
  }
  derived = path + text;
  by('lecture').className = '';
  by('lecture').innerHTML = `<h2>${escapedText(title)}</h2>${html}`;
  document.documentElement.dataset.derived = path;
  return true;
}

// Pointing at a name shows it in the picture.
const lit = new Set();
function light(names) {
  lit.clear();
  names.forEach(name => lit.add(name));
  document.querySelectorAll('[data-name]').forEach(e => e.classList.toggle('lit', lit.has(e.dataset.name)));
  marks = null;
}
const namesAt = target => {
  const named = target.closest?.('[data-name]');
  return named ? [named.dataset.name] : [];
};
by('derivation').addEventListener('pointerover', event => light(namesAt(event.target)));
by('derivation').addEventListener('pointerleave', () => light([]));

// --- the scene -------------------------------------------------------------------------------

async function reload() {
  const mine = ++edition;
  hint('reading …');
  mover.restart();
  await mover.ask({do: 'write', files: {...texts.specs, [scenePath()]: texts.scene}});
  const loaded = await mover.ask({do: 'load', path: scenePath(), ...wishes()}, 20);
  if (mine !== edition || loaded.replaced) return;
  if (loaded.problems) {
    if (shown === 'scene') showMessages(messagesIn(loaded.problems));
    hint('The text has a mistake. The picture is of the last text without one.', true);
    scene = null;
  } else {
    if (shown === 'scene') showMessages(messagesIn(loaded.warnings));
    begin(loaded);
  }
  await derive();
  document.documentElement.dataset.edition = mine;
}

const wishes = () => ({...(by('method').value && {method: by('method').value}), ...(by('rate').value && {rate: +by('rate').value})});

function begin(loaded) {
  scene = loaded, hand = grabbed = null;
  hint(scene.title);
  view.show(scene);
  const chosen = by('joints').value, types = [...new Set(scene.joints.map(joint => joint.type))];
  by('joints').replaceChildren(...types.map(type => new Option(type, type)));
  if (types.includes(chosen)) by('joints').value = chosen;
  else by('joints').value = types.find(type => texts.specs[own(type) + '.joint']) ?? types[0] ?? '';
  if (by('method').options.length === 0)
    by('method').replaceChildren(new Option('chosen for you', ''), ...scene.methods.map(name => new Option(name, name)));
  const down = scene.dimension === 2 ? 1 : 2;
  by('gravity').value = Math.hypot(...scene.gravity) || 0;
  scene.down = Math.hypot(...scene.gravity) > 0 ? scene.gravity.map(v => v / Math.hypot(...scene.gravity)) : [0, 0, 0].map((_, k) => k === down ? -1 : 0);
  by('gravity-now').textContent = `${(+by('gravity').value).toFixed(2)} m/s²`;
  showMotors();
  by('plots').replaceChildren();
  plots = [new Plot('energy', 'J'), new Plot('largest gap of a joint', 'm, rad'), ...scene.sensors.map(s => new Plot(s.name, s.unit))];
  take(scene.state);
}

function showMotors() {
  by('motors').replaceChildren(...scene.joints.flatMap((joint, k) => joint.motors.map(motor => {
    const label = document.createElement('label'), slider = document.createElement('input'), now = document.createElement('output');
    const most = 3 * Math.max(1, Math.abs(motor.speed));
    Object.assign(slider, {type: 'range', min: -most, max: most, step: most / 200, value: motor.speed});
    const tell = () => now.textContent = `${(+slider.value).toFixed(2)} per s`;
    tell();
    slider.addEventListener('input', () => {
      tell();
      mover.ask({do: 'motor', joint: k, effect: motor.effect, speed: +slider.value, ...(motor.max !== undefined && {max: motor.max})});
    });
    label.append(`Motor of ${joint.name} `, slider, now);
    return label;
  })));
}

function take(state) {
  if (state.problems) return hint(state.problems, true);
  view.setPlaces(state.bodies);
  plots[0]?.add(state.time, state.energy);
  plots[1]?.add(state.time, state.error);
  state.sensors.forEach((value, k) => plots[2 + k]?.add(state.time, value));
  by('cost').textContent = state.cpu > 0 ? `${(1000 * state.cpu).toPrecision(2)} ms of computing per second` : '';
  if (state.failed) hint(state.failed, true);
  Object.assign(document.documentElement.dataset, {time: state.time, bodies: JSON.stringify(state.bodies), error: state.error});
}

let last = performance.now();
async function frame(now) {
  const passed = Math.min(0.05, (now - last) / 1000);
  last = now;
  if (scene && !busy && (playing || stepOnce)) {
    busy = true;
    const mine = edition, time = stepOnce ? 1 / 60 : passed * +by('speed').value;
    stepOnce = false;
    const state = await mover.ask({do: 'step', time});
    if (mine === edition && !state.replaced) take(state);
    if (lit.size && scene && !marks) await findMarks();
    else if (lit.size && scene && playing) await findMarks();
    busy = false;
  }
  view.draw(lit.size && marks ? {...marks, lit} : null, hand);
  plots.forEach(plot => plot.draw());
  requestAnimationFrame(frame);
}

async function findMarks() {
  const joint = scene.joints.findIndex(one => one.type === by('joints').value);
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
  mover.ask({do: 'drag', body: hand.body, local: hand.local, target: hand.target});
});
const release = () => {
  if (hand) mover.ask({do: 'drop'});
  hand = grabbed = null;
};
stage.addEventListener('pointerup', release);
stage.addEventListener('pointercancel', release);
stage.addEventListener('wheel', event => {
  event.preventDefault();
  view.camera.zoom = Math.max(0.05, Math.min(50, view.camera.zoom * Math.exp(-0.001 * event.deltaY)));
}, {passive: false});

// --- controls --------------------------------------------------------------------------------

function setPlaying(on) {
  playing = on;
  by('play').textContent = on ? 'Pause' : 'Play';
}
by('play').addEventListener('click', () => setPlaying(!playing));
by('once').addEventListener('click', () => {
  setPlaying(false);
  stepOnce = true;
});
by('again').addEventListener('click', reload);
by('gravity').addEventListener('input', async () => {
  by('gravity-now').textContent = `${(+by('gravity').value).toFixed(2)} m/s²`;
  if (scene) mover.ask({do: 'change', ...wishes(), gravity: scene.down.map(v => v * +by('gravity').value)});
});
for (const id of ['method', 'rate'])
  by(id).addEventListener('change', () => {
    if (scene) mover.ask({do: 'change', ...wishes(), gravity: scene.down.map(v => v * +by('gravity').value)}).then(take);
  });
by('rate').replaceChildren(new Option('as written', ''), ...[60, 120, 240, 480, 1000, 4000].map(n => new Option(n, n)));
by('tab-scene').addEventListener('click', () => (shown = 'scene', showText()));
by('tab-spec').addEventListener('click', () => (shown = 'spec', showText()));
by('joints').addEventListener('change', () => (showText(), derive()));
const setDark = on => document.documentElement.classList.toggle('dark', on);
by('theme').addEventListener('click', () => setDark(!document.documentElement.classList.contains('dark')));
by('share').addEventListener('click', async () => {
  location.hash = toFragment(texts);
  try {
    await navigator.clipboard.writeText(location.href);
    hint('The link is in the clipboard.');
  } catch {
    hint('The link is in the address bar.');
  }
});
stage.addEventListener('keydown', event => {
  const turn = {ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1]}[event.key];
  if (event.key === ' ') setPlaying(!playing);
  else if (event.key === '.') setPlaying(false), stepOnce = true;
  else if (turn) view.camera.yaw += turn[0], view.camera.pitch += turn[1];
  else return;
  event.preventDefault();
});

function open(example) {
  texts = {scene: example.scene, specs: {...example.specs}};
  by('joints').replaceChildren();
  showText();
  reload();
}
by('gallery').replaceChildren(...data.gallery.map((one, k) => new Option(one.title, k)));
by('gallery').addEventListener('change', () => open(data.gallery[+by('gallery').value]));
setDark(matchMedia('(prefers-color-scheme: dark)').matches);
open(fromFragment(location.hash.slice(1)) ?? data.gallery[0]);
requestAnimationFrame(frame);
