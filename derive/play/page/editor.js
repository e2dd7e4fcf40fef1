// The texts: the scene and the specs of its joints, with messages at their places.
const editor = by('editor'), underlines = by('marks');

const dimensionOf = scene => /^\s*dimension\s*=\s*3/m.test(scene) ? 3 : 2;
const folderOf = scene => dimensionOf(scene) === 3 ? 'specs/spatial/' : 'specs/planar/';
const escapedText = text => text.replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;');

// "file:3:5: error: cause", lines of the text with carets, "fix: …" to messages with places.
function messagesIn(report) {
  const messages = [];
  for (const line of report.split('\n')) {
    const head = /^[^\s:]*(?::(\d+)(?::(\d+))?)?: (error|warning): (.*)$/.exec(line), last = messages.at(-1);
    if (head) messages.push({line: +head[1] || 1, column: +head[2] || 1, end: 0, severity: head[3], message: head[4], fix: ''});
    else if (last && /^\s*fix: /.test(line)) last.fix = line.trim().slice(5);
    else if (last && !last.end && /^\s*\|\s*\^/.test(line)) last.end = last.column + /\^~*/.exec(line)[0].length;
    else if (last && line.trim() && !line.includes('|')) last.message += '\n' + line.trim();
    else if (!last && line.trim()) messages.push({line: 1, column: 1, end: 1, severity: 'error', message: line.trim(), fix: ''});
  }
  return messages;
}

// The places of messages are lines and columns of the text in the editor.
function showMessages(messages) {
  const lines = editor.value.split('\n');
  const marked = lines.map((text, k) => {
    const here = messages.find(m => m.line === k + 1);
    if (!here || !text) return escapedText(text);
    const begin = Math.min(here.column - 1, text.length - 1), end = Math.max(begin + 1, here.end - 1);
    return `${escapedText(text.slice(0, begin))}<mark class="${here.severity}">${escapedText(text.slice(begin, end))}</mark>` +
        escapedText(text.slice(end));
  });
  underlines.innerHTML = marked.join('\n') + '\n';
  scrollUnderlines();
  by('messages').replaceChildren(...messages.map(m => {
    const button = document.createElement('button');
    button.className = m.severity;
    button.innerHTML = `<b>Line ${m.line}</b> ${escapedText(m.message)}` + (m.fix ? `<small>Likely fix: ${escapedText(m.fix)}</small>` : '') +
        (m.generated ? `<small>Generated: ${escapedText(m.generated)}</small>` : '');
    button.addEventListener('click', () => {
      const start = lines.slice(0, m.line - 1).reduce((sum, text) => sum + text.length + 1, 0) + m.column - 1;
      editor.focus();
      editor.setSelectionRange(start, start + Math.max(1, m.end - m.column));
    });
    return button;
  }));
}

function scrollUnderlines() {
  underlines.scrollTop = editor.scrollTop;
  underlines.scrollLeft = editor.scrollLeft;
}
editor.addEventListener('scroll', scrollUnderlines);

// A link carries all texts in its fragment.
const toFragment = value => btoa(String.fromCharCode(...new TextEncoder().encode(JSON.stringify(value))))
                                .replace(/\+/g, '-').replace(/\//g, '_').replace(/=+$/, '');
function fromFragment(text) {
  try {
    const bytes = atob(text.replace(/-/g, '+').replace(/_/g, '/'));
    return JSON.parse(new TextDecoder().decode(Uint8Array.from(bytes, c => c.charCodeAt(0))));
  } catch {
    return null;
  }
}
