// Controls below the picture: time, gravity, method, motors and parameters; and the keys of the picture.
const wishes = () => ({...(by('method').value && {method: by('method').value}), ...(by('rate').value && {rate: +by('rate').value}),
                       measure: by('measure').checked});
const changed = () => ({do: 'change', ...wishes(), gravity: scene.down.map(v => v * +by('gravity').value)});

// A range with its name and its number; `moved(value)` as it moves.
function slider(name, unit, {least, most, value}, moved) {
  const label = document.createElement('label'), range = document.createElement('input'), now = document.createElement('output');
  Object.assign(range, {type: 'range', min: least, max: most, step: 'any', value});
  const tell = () => now.textContent = `${+(+range.value).toPrecision(3)} ${unit}`.trim();
  tell();
  range.addEventListener('input', () => (tell(), moved(+range.value)));
  label.append(`${name} `, range, now);
  return label;
}

const tellProblem = state => state.problems && !state.replaced && hint(state.problems, true);

function showMotors() {
  by('motors').replaceChildren(...scene.joints.flatMap((joint, k) => joint.motors.map(motor => {
    const most = 3 * Math.max(1, Math.abs(motor.speed));
    return slider(`Motor of ${joint.name}`, 'per s', {least: -most, most, value: motor.speed}, speed =>
        mover.ask({do: 'motor', joint: k, effect: motor.effect, speed, ...(motor.max !== undefined && {max: motor.max})}).then(tellProblem));
  })));
}

// Numbers of joints and effects, from a quarter to four times their value.
const mostSliders = 24;
function showParameters() {
  const rangeOf = v => v === 0 ? {least: -1, most: 1, value: 0} : {least: Math.min(v / 4, 4 * v), most: Math.max(v / 4, 4 * v), value: v};
  const all = scene.joints.flatMap((joint, k) => joint.parameters.filter(p => p.kind === 'scalar' && Number.isFinite(p.numbers[0])).map(
      p => slider(`${p.name} of ${joint.name}`, p.unit, rangeOf(p.numbers[0]), value =>
          mover.ask({do: 'set', joint: k, name: p.name, numbers: [value]}).then(tellProblem))));
  by('parameters').hidden = all.length === 0;
  by('sliders').replaceChildren(...all.slice(0, mostSliders));
}

function showPlots() {
  by('plots').replaceChildren();
  by('carrier').replaceChildren(...scene.joints.map((joint, k) => new Option(joint.name, k)));
  by('carried').hidden = scene.joints.length === 0;
  plots = [
    {plot: new Plot('energy', 'J'), of: state => state.energy},
    {plot: new Plot('largest gap of a joint', 'm, rad'), of: state => state.error},
    ...(scene.joints.length ? [{plot: new Plot('force in the joint', 'N'), of: state => state.forces[+by('carrier').value]}] : []),
    ...(by('measure').checked ? [{plot: new Plot('distance to the same run with steps 8 times shorter', 'm'), of: state => state.off}] : []),
    ...scene.sensors.map((s, k) => ({plot: new Plot(s.name, s.unit), of: state => state.sensors[k]}))
  ];
}
by('carrier').addEventListener('change', () => plots[2]?.plot.clear());

function showControls() {
  if (by('method').options.length === 0)
    by('method').replaceChildren(new Option('chosen for you', ''), ...scene.methods.map(name => new Option(name, name)));
  const size = Math.hypot(...scene.gravity), down = scene.dimension === 2 ? 1 : 2;
  by('gravity').value = size;
  by('gravity-now').textContent = `${size.toFixed(2)} m/s²`;
  scene.down = size > 0 ? scene.gravity.map(v => v / size) : [0, 0, 0].map((_, k) => k === down ? -1 : 0);
  showMotors();
  showParameters();
  showPlots();
}

function setPlaying(on) {
  playing = on;
  by('play').textContent = on ? 'Pause' : 'Play';
}
function stepOn() {
  setPlaying(false);
  stepOnce = true;
}
by('play').addEventListener('click', () => setPlaying(!playing));
by('once').addEventListener('click', stepOn);
by('again').addEventListener('click', () => reload());
by('gravity').addEventListener('input', () => {
  by('gravity-now').textContent = `${(+by('gravity').value).toFixed(2)} m/s²`;
  if (live) mover.ask(changed());
});
for (const id of ['method', 'rate', 'measure'])
  by(id).addEventListener('change', () => {
    if (id === 'measure' && scene) showPlots();
    if (live) mover.ask(changed()).then(take);
  });
by('rate').replaceChildren(new Option('as written', ''), ...[60, 120, 240, 480, 1000, 4000].map(n => new Option(n, n)));
const setDark = on => {
  document.documentElement.classList.toggle('dark', on);
  by('theme').textContent = on ? 'Light' : 'Dark';
};
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

// --- keys of the picture -----------------------------------------------------------------------

const directions = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
let chosen = -1;  // the body that the keys pull

function chooseBody(next) {
  const movable = scene.bodies.map((_, k) => k).filter(k => !scene.bodies[k].static);
  if (!movable.length) return say('No body can move.');
  chosen = movable[(movable.indexOf(chosen) + next + movable.length) % movable.length];
  release();
  say(`${scene.bodies[chosen].name}. Shift and the arrow keys pull it.`);
}

// By a twentieth of the mechanism's size for each press.
function pullChosen([right, up]) {
  if (chosen < 0) chooseBody(1);
  const place = view.places[chosen], axes = view.axes(), reach = view.radius / 20;
  hand ??= {body: chosen, local: [0, 0, 0], target: [...place.x]};
  hand.target = hand.target.map((v, k) => v + reach * (right * axes.right[k] + up * axes.up[k]));
  mover.ask({do: 'drag', ...hand});
}

function describeState() {
  const at = place => place.x.slice(0, scene.dimension).map(v => v.toFixed(2)).join(', ');
  const most = 8, bodies = scene.bodies.map((body, k) => `${body.name} at ${at(view.places[k])}`);
  say(`Time ${document.documentElement.dataset.time} s. ${bodies.slice(0, most).join('; ')}${bodies.length > most ? '; and others' : ''}.`);
}

stage.addEventListener('keydown', event => {
  if (!scene) return;
  const direction = directions[event.key];
  if (event.key === ' ') setPlaying(!playing);
  else if (event.key === '.') stepOn();
  else if (event.key === 'b' || event.key === 'B') chooseBody(event.key === 'b' ? 1 : -1);
  else if (event.key === 'd') describeState();
  else if (event.key === 'Escape') release();
  else if (direction && event.shiftKey) pullChosen(direction);
  else if (direction) view.camera.yaw -= 0.1 * direction[0], view.camera.pitch += 0.1 * direction[1];
  else return;
  event.preventDefault();
});
