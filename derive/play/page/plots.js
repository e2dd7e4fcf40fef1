// Curves over the time, each with its unit and its range.
class Plot {
  #points = [];

  constructor(name, unit) {
    this.unit = unit;
    const figure = document.createElement('figure'), caption = document.createElement('figcaption');
    const label = document.createElement('span');
    label.textContent = unit ? `${name} [${unit}]` : name;
    this.now = document.createElement('b');
    this.canvas = document.createElement('canvas');
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', `${name} over the time`);
    caption.append(label, this.now);
    figure.append(caption, this.canvas);
    by('plots').append(figure);
  }

  clear() { this.#points = []; }

  add(time, value) {
    if (!Number.isFinite(value)) return;
    this.#points.push([time, value]);
    if (this.#points.length > 1200) this.#points.shift();
    this.now.textContent = value.toPrecision(4);
  }

  draw() {
    const ratio = devicePixelRatio || 1, wide = this.canvas.clientWidth, high = this.canvas.clientHeight;
    this.canvas.width = ratio * wide, this.canvas.height = ratio * high;
    const on = this.canvas.getContext('2d');
    on.scale(ratio, ratio);
    if (this.#points.length < 2) return;
    const values = this.#points.map(p => p[1]), first = this.#points[0][0], last = this.#points.at(-1)[0];
    let least = Math.min(...values), most = Math.max(...values);
    if (most - least < 1e-12 * Math.max(Math.abs(most), 1e-12)) least -= 1e-12, most += 1e-12;
    const x = t => 50 + (wide - 56) * (t - first) / (last - first || 1), y = v => high - 16 - (high - 24) * (v - least) / (most - least);
    on.fillStyle = colour('soft'), on.font = '10px system-ui, sans-serif';
    on.fillText(most.toPrecision(3), 0, 12), on.fillText(least.toPrecision(3), 0, high - 14);
    on.fillText(`${first.toFixed(1)} s`, 50, high - 2), on.fillText(`${last.toFixed(1)} s`, wide - 34, high - 2);
    on.strokeStyle = colour('line');
    on.strokeRect(50, 6, wide - 56, high - 22);
    on.beginPath();
    this.#points.forEach(([t, v], k) => k ? on.lineTo(x(t), y(v)) : on.moveTo(x(t), y(v)));
    on.strokeStyle = colour('accent'), on.lineWidth = 1.5;
    on.stroke();
  }
}
