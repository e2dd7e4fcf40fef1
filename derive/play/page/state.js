// The state of the page. Texts and drags become requests to two engines: one reads and derives, one
// moves.
const reader = new Engine(), mover = new Engine();
const view = new View();
let texts = {scene: '', specs: {}};  // specs: own ones and derivations by hand, by their file
let shown = 'scene';                 // the tab of the texts
let scene = null, live = false;      // as the engine described it; whether the engine has it
let playing = true, stepOnce = false, edition = 0;
let hand = null, grabbed = null;     // the pointer's spring; what the pointer moves
let marks = null, plots = [];

const hint = (text, wrong = false) => {
  by('hint').textContent = text;
  by('hint').className = wrong ? 'wrong' : '';
};
// For those who listen.
const say = text => by('spoken').textContent = text;
