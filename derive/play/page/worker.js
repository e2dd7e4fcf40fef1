// The engine in a Worker, after the glue of its compiler: requests in, answers out, so that the page never freezes.
let ask = null;

async function begin({module, files}) {
  const engine = await CdotEngine({
    instantiateWasm(imports, done) {
      WebAssembly.instantiate(module, imports).then(instance => done(instance, module));
      return {};
    }
  });
  ask = text => engine.ccall('cdot_ask', 'string', ['string'], [text]);
  ask(JSON.stringify({do: 'write', files}));
}

self.onmessage = async ({data}) => {
  try {
    if (data.module) await begin(data);
    postMessage({id: data.id, answer: data.text ? ask(data.text) : '{}'});
  } catch (error) {
    postMessage({id: data.id, crash: String(error)});
  }
};
