// States of the contacts over time, a line each: bars for what lasts, ticks for impacts.
const LINE = 20, LABELS = 110;

class Timeline {
  constructor(run, canvas, seek) {
    this.run = run;
    this.canvas = canvas;
    this.contacts = run.contacts;
    canvas.style.height = `${LINE * Math.max(this.contacts.length, 1) + 26}px`;
    canvas.addEventListener("click", (event) => {
      const x = event.offsetX - this.labels();
      if (x >= 0) seek(this.range[0] + (x / (this.width - this.labels())) * (this.range[1] - this.range[0]));
    });
  }

  labels() { return Math.min(LABELS, 0.3 * this.width); }

  resize() {
    const ratio = window.devicePixelRatio || 1;
    this.width = this.canvas.clientWidth;
    this.height = this.canvas.clientHeight;
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.ratio = ratio;
    this.picture = null;
  }

  show(range) {
    this.range = range;
    this.picture = null;
  }

  draw(time) {
    const context = this.canvas.getContext("2d");
    if (!this.picture) this.paint();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.drawImage(this.picture, 0, 0);
    context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    const x = this.x(time);
    if (x < this.labels() || x > this.width) return;
    context.fillStyle = colour("accent");
    context.fillRect(x - 0.5, 0, 1.5, LINE * this.contacts.length + 4);
  }

  x(time) {
    return this.labels() + ((time - this.range[0]) / (this.range[1] - this.range[0] || 1)) * (this.width - this.labels());
  }

  // What does not change while the animation runs.
  paint() {
    this.picture = document.createElement("canvas");
    this.picture.width = this.canvas.width;
    this.picture.height = this.canvas.height;
    const context = this.picture.getContext("2d");
    context.scale(this.ratio, this.ratio);
    context.font = "12px system-ui, sans-serif";
    context.textBaseline = "middle";
    this.contacts.forEach((contact, k) => this.paintContact(context, contact, k * LINE + 3));
    this.paintAxis(context);
  }

  paintContact(context, contact, top) {
    const height = LINE - 5, states = this.run.states;
    for (const impacts of [false, true]) // on top of the bars
      for (const [start, end, code] of contact.intervals) {
        const state = states[code].toLowerCase();
        if ((state === "impact") !== impacts) continue;
        const from = Math.max(this.x(start), this.labels()), to = Math.min(this.x(end), this.width);
        if (to < this.labels() || from > this.width) continue;
        context.fillStyle = colour(state);
        if (impacts) context.fillRect(from - 1, top - 2, Math.max(to - from, 2), height + 4);
        else if (state === "open") context.fillRect(from, top + height / 2 - 1, Math.max(to - from, 1), 2);
        else context.fillRect(from, top + (state === "slip" ? height / 4 : 0), Math.max(to - from, 1), state === "slip" ? height / 2 : height);
      }
    context.fillStyle = colour("front");
    context.textAlign = "right";
    context.fillText(shortened(context, contact.name, this.labels() - 8), this.labels() - 6, top + height / 2);
  }

  paintAxis(context) {
    const y = LINE * this.contacts.length + 16;
    const digits = digitsOf(this.range, (this.range[1] - this.range[0]) / 100, 4);
    context.fillStyle = colour("soft");
    for (const [part, align] of [[0, "left"], [0.5, "center"], [1, "right"]]) {
      context.textAlign = align;
      const time = this.range[0] + part * (this.range[1] - this.range[0]);
      context.fillText(written(time, "s", digits), this.labels() + part * (this.width - this.labels() - 4), y);
    }
  }
}

function shortened(context, text, width) {
  let kept = text;
  while (context.measureText(kept).width > width && kept.length > 2) kept = `${kept.slice(0, -2)}…`;
  return kept;
}
