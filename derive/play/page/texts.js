// The texts: of the scene, of a joint's spec, and of derivations by hand. Each answers as it is typed.
const own = name => `${folderOf(texts.scene)}${name}`;
const scenePath = () => own('scene.toml');

// The specs of a joint and of the effects on its coordinates. Their names may be those of effects between bodies.
const onCoordinate = 'coordinate/';
const typesOf = joint => [joint.type, ...joint.laws.map(law => onCoordinate + law)];
const nameOf = type => type.replace(onCoordinate, '').replace(/#\d+$/, '');
// The file of the spec that the panel shows: that of the chosen joint or effect.
const chosenSpec = () => nameOf(by('joints').value) || 'revolute';
const isOwn = type => ['.joint', '.effect'].some(ending => texts.specs[own(nameOf(type)) + ending] !== undefined);
function specFile() {
  const file = own(chosenSpec()), law = by('joints').value.startsWith(onCoordinate);
  if (law) return texts.specs[file + '.effect'] ? file + '.effect' : `specs/${by('joints').value}.effect`;
  return textOf(file + '.effect') ? file + '.effect' : file + '.joint';
}
const handFile = () => specFile().replace(/\.(joint|effect)$/, '.hand');
const textOf = file => texts.specs[file] ?? data.files[file] ?? '';
const tabs = {
  scene: {read: () => texts.scene, write: text => texts.scene = text, answer: () => reload()},
  spec: {read: () => textOf(specFile()), write: adopt, answer: () => reload()},
  hand: {read: () => textOf(handFile()), write: text => texts.specs[handFile()] = text, answer: () => judge()}
};

async function showText() {
  for (const tab of Object.keys(tabs)) by(`tab-${tab}`).setAttribute('aria-selected', shown === tab);
  if (shown === 'hand' && !textOf(handFile())) {
    const {text} = await reader.ask({do: 'hand', path: specFile()});
    if (text) texts.specs[handFile()] = text;
  }
  editor.value = tabs[shown].read();
  showMessages([]);
  if (shown === 'hand') await judge();
}

// A copy from the catalogue gets a name of its own, in its header and in the scene: there as a type, or as an effect on
// a coordinate (angle.spring = …).
function adopt(text) {
  const file = specFile(), name = chosenSpec();
  if (!data.files[file] || texts.specs[file]) return texts.specs[file] = text;
  const mine = `my_${name}`;
  const law = file.startsWith('specs/coordinate/');
  texts.scene = law ?
      texts.scene.replace(new RegExp(`([.{,]\\s*)${name}(?=\\s*[=.\\]])`, 'g'), `$1${mine}`) :
      texts.scene.replaceAll(`"${name}"`, `"${mine}"`);
  const option = [...by('joints').options].find(one => one.value === by('joints').value);
  option.value = law ? onCoordinate + mine : mine;
  option.textContent = mine;
  const renamed = text.replace(new RegExp(`^(\\s*(?:joint|effect)\\s+)${name}\\b`, 'm'), `$1${mine}`);
  return texts.specs[own(mine) + /\.\w+$/.exec(file)[0]] = renamed;
}

let waiting = 0;
editor.addEventListener('input', () => {
  const text = tabs[shown].write(editor.value);
  if (text !== editor.value) {
    const at = editor.selectionStart + text.length - editor.value.length;
    editor.value = text;
    editor.setSelectionRange(at, at);
  }
  clearTimeout(waiting);
  waiting = setTimeout(tabs[shown].answer, 250);
});

let derived = '';  // the spec whose derivation is shown
async function derive() {
  const path = specFile(), text = textOf(path);
  if (!text) return;
  await reader.ask({do: 'write', files: texts.specs});
  const checked = await reader.ask({do: 'check', path});
  if (shown === 'spec') showMessages(checked.messages ?? messagesIn(checked.problems ?? ''));
  if ((checked.messages ?? [{severity: 'error'}]).some(m => m.severity === 'error'))
    return by('lecture').classList.add('stale');
  if (derived === path + text) {
    by('lecture').classList.remove('stale');
    return by('code') ? undefined : showKernel();
  }
  const lecture = await reader.ask({do: 'explain', path}, 20);
  if (lecture.replaced) return;
  if (!lecture.problems) return showLecture(path, lecture), showKernel();
  if (shown === 'spec') showMessages(messagesIn(lecture.problems));
}

function showLecture(path, {title, html}) {
  derived = path + textOf(path);
  by('lecture').className = '';
  by('lecture').innerHTML = `<h2>${escapedText(title)}</h2>${html}`;
  document.documentElement.dataset.derived = path;
}

// The C++ below the derivation.
async function showKernel() {
  const mine = derived, {html, replaced} = await reader.ask({do: 'kernel', path: specFile()}, 20);
  if (!html || replaced || mine !== derived) return;
  const kernel = document.createElement('section');
  kernel.innerHTML = `<h2>The kernel</h2><pre id="code">${html}</pre>`;
  by('code')?.parentElement.remove();
  by('lecture').append(kernel);
}

// The verdicts on the derivations by hand of the chosen spec.
async function judge() {
  const path = handFile(), text = textOf(path);
  document.documentElement.dataset.judged = '';
  await reader.ask({do: 'write', files: {...texts.specs, [path]: text}});
  const {messages, problems, agree, differ, replaced} = await reader.ask({do: 'judge', path}, 60);
  if (replaced || shown !== 'hand' || text !== textOf(handFile())) return;
  showMessages(messages ?? messagesIn(problems));
  document.documentElement.dataset.judged = problems ? 'unreadable' : `${agree} agree, ${differ} differ`;
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

for (const tab of Object.keys(tabs)) by(`tab-${tab}`).addEventListener('click', () => (shown = tab, showText()));
by('joints').addEventListener('change', () => (showText(), derive()));
