// Engines in Workers. A request that takes too long, or that crashes, ends its Worker: the next one begins anew.
const by = id => document.getElementById(id);
const data = JSON.parse(by('data').textContent);

// A page of `cdot play` without WebAssembly asks the machine that serves it, one request after the other.
class ServedWorker {
  static all = new Set();
  #name = Array.from(crypto.getRandomValues(new Uint8Array(12)), byte => byte.toString(16).padStart(2, '0')).join('');
  #last = Promise.resolve();

  constructor() { ServedWorker.all.add(this); }
  postMessage({id, text, files}) {
    const body = files ? JSON.stringify({do: 'write', files}) : text;
    this.#last = this.#last.then(async () => {
      const answer = await fetch(`engine/${this.#name}`, {method: 'POST', body}).catch(() => null);
      const told = answer ? await answer.text() : 'the program that serves this page has ended';
      this.onmessage?.({data: answer?.ok ? {id, answer: told} : {id, crash: told}});
    });
  }
  terminate() {
    this.onmessage = null;
    ServedWorker.all.delete(this);
    fetch(`engine/${this.#name}`, {method: 'DELETE', keepalive: true}).catch(() => {});
  }
}
addEventListener('pagehide', () => ServedWorker.all.forEach(worker => worker.terminate()));

const engineModule = data.served ? null : (async () => {
  const text = atob(by('wasm').textContent.trim());
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < bytes.length; ++k) bytes[k] = text.charCodeAt(k);
  return WebAssembly.compile(bytes);
})();
const engineSource = URL.createObjectURL(
    new Blob([by('glue').textContent, '\n', by('worker').textContent], {type: 'text/javascript'}));

const replaced = {problems: 'replaced by a newer request', replaced: true};

class Engine {
  #worker = null;
  #waiting = new Map();
  #number = 0;
  #ready = null;

  // Resolves to the answer; its `problems` is text for people.
  async ask(request, seconds = 10) {
    const ready = this.#ready ??= this.#begin();
    await ready;
    if (ready !== this.#ready) return replaced;  // this Worker ended meanwhile
    return this.#send({text: JSON.stringify(request)}, seconds);
  }

  // Forgets all that the Worker knew.
  restart() {
    this.#worker?.terminate();
    for (const {done} of this.#waiting.values()) done(replaced);
    this.#waiting.clear();
    this.#worker = this.#ready = null;
  }

  async #begin() {
    const worker = this.#worker = data.served ? new ServedWorker() : new Worker(engineSource);
    worker.onmessage = ({data: {id, answer, crash}}) => {
      const waiting = this.#waiting.get(id);
      if (!waiting) return;
      this.#waiting.delete(id);
      clearTimeout(waiting.timer);
      if (crash) this.restart();
      waiting.done(crash ? {problems: `The computation broke down: ${crash}. It began anew.`} : JSON.parse(answer));
    };
    return this.#send({module: await engineModule, files: data.files}, 30);
  }

  #send(message, seconds) {
    return new Promise(done => {
      const id = ++this.#number;
      const timer = setTimeout(() => {
        this.#waiting.delete(id);
        this.restart();
        done({problems: `This took more than ${seconds} s and was stopped. Likely fix: a smaller equation or mechanism.`});
      }, 1000 * seconds);
      this.#waiting.set(id, {done, timer});
      this.#worker.postMessage({id, ...message});
    });
  }
}
