// What the reader sees and does: one time, one range of times, everything follows them.
const SHOWN_IN = 10, FLASH = 0.25; // seconds in which the whole run is shown, and in which an impulse is
const MOST_EVENTS = 300;
const MEANINGS = {
  OPEN: "open", CLOSED: "closed", STICK: "sticks", SLIP: "slides", IMPACT: "impact", HELD: "held (joint)",
};
const BECOMES = { OPEN: "opens", CLOSED: "closes", STICK: "sticks", SLIP: "slides" };
const AFTER = { OPEN: "bounces", CLOSED: "stays closed", STICK: "sticks", SLIP: "slides" };
const get = (id) => document.getElementById(id);

class Page {
  constructor(run) {
    this.run = run;
    this.t = run.values.t;
    this.time = this.t[0];
    this.playing = false;
    this.pace = (run.span[1] - run.span[0]) / SHOWN_IN;
    this.impacts = impactsOf(run);
    this.events = eventsOf(run);
    this.range = run.span[0] < run.span[1] ? [...run.span] : [run.span[0], run.span[0] + 1];
    this.whole = [...this.range];
    this.digits = digitsOf(run.span, (run.span[1] - run.span[0]) / run.rows[1], 6); // of the time of a row
    get("animation").hidden = !run.shapes;
    if (run.shapes?.length) this.scene = new SceneView(run, get("scene"), () => this.draw());
    else if (run.shapes) this.hideScene();
    if (run.contacts.length) this.timeline = new Timeline(run, get("timeline"), (time) => this.seek(time));
    else get("contacts").hidden = true;
    this.plots = new Plots(run, get("plots"), this.impacts, (range) => this.zoom(range), (time) => this.seek(time));
    this.fill();
    this.listen();
    this.resize();
    this.zoom(this.range);
  }

  hideScene() {
    get("scene").parentNode.hidden = true;
    const hint = document.createElement("p");
    hint.textContent = "This model has no shapes to show; give its systems some with add_shape(shape, pose).";
    get("animation").insertBefore(hint, get("animation").children[1]);
  }

  fill() {
    const { run } = this;
    for (const part of ["run", "certificate", "provenance"]) facts(get(`summary-${part}`), run.summary[part], part === "run");
    legend(get("states"), run.states.filter((_, k) => run.contacts.some((c) => c.intervals.some((i) => i[2] === k))));
    if (this.scene && run.arrow_names.length) arrowLegend(get("legend"), run.largest);
    const body = get("events").tBodies[0];
    for (const event of this.events.slice(0, MOST_EVENTS)) body.append(eventRow(event, this.digits, (time) => this.seek(time)));
    if (this.events.length > MOST_EVENTS) get("more-events").textContent = `… and ${this.events.length - MOST_EVENTS} more.`;
    if (run.more_contacts) get("more-events").textContent += ` ${run.more_contacts} contacts that carried less are left out.`;
    if (run.coarse) get("more-events").textContent += ` States change too often for a page: it looks at ${run.coarse} rows.`;
    const chooser = get("chooser");
    chooser.hidden = this.plots.contacts.length < 2;
    this.plots.contacts.forEach((name, k) => chooser.append(choice(name, paletteColour(k), this.plots)));
    const [kept, all] = run.rows;
    get("rows").textContent = kept === all ? `All ${all} rows of the run are in this page.`
      : `${kept} of ${all} rows of the run are in this page: impacts, the extremes of every plot, and others evenly.`;
    if (run.more_shapes) get("rows").textContent += ` ${run.more_shapes} shapes are left out.`;
    get("time").min = run.span[0];
    get("time").max = run.span[1];
  }

  listen() {
    const on = (id, action, kind = "click") => get(id).addEventListener(kind, action);
    on("play", () => this.play(!this.playing));
    on("back", () => this.stepRows(-1));
    on("forward", () => this.stepRows(1));
    on("time", () => this.seek(Number(get("time").value)), "input");
    on("speed", () => this.draw(), "change");
    on("names", () => { if (this.scene) this.scene.names = get("names").checked; this.draw(); }, "change");
    on("view", () => { if (this.scene) this.scene.view.fit(); this.draw(); });
    on("closer", () => this.scale(0.5));
    on("farther", () => this.scale(2));
    on("earlier", () => this.pan(-0.25));
    on("later", () => this.pan(0.25));
    on("whole", () => this.zoom(this.whole));
    window.addEventListener("resize", () => this.resize());
    document.addEventListener("keydown", (event) => this.key(event));
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.resize());
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|SELECT|BUTTON|SUMMARY)$/.test(event.target.tagName) && event.key === " ") return;
    if (/^(INPUT|SELECT)$/.test(event.target.tagName) && /^(Arrow|Home|End)/.test(event.key)) return;
    const keys = {
      " ": () => this.play(!this.playing),
      ArrowLeft: () => (event.shiftKey ? this.pan(-0.25) : this.stepRows(-1)),
      ArrowRight: () => (event.shiftKey ? this.pan(0.25) : this.stepRows(1)),
      Home: () => this.seek(this.run.span[0]),
      End: () => this.seek(this.run.span[1]),
      n: () => this.toImpact(1),
      p: () => this.toImpact(-1),
      "+": () => this.scale(0.5),
      "-": () => this.scale(2),
      0: () => this.zoom(this.whole),
    };
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  }

  play(wanted) {
    if (wanted && this.time >= this.run.span[1]) this.time = this.run.span[0];
    this.playing = wanted;
    get("play").textContent = wanted ? "Stop" : "Play";
    get("play").setAttribute("aria-pressed", String(wanted));
    let last = null;
    const frame = (now) => {
      if (!this.playing) return;
      if (last !== null) this.move(this.time + ((now - last) / 1000) * this.pace * this.speed());
      last = now;
      if (this.time >= this.run.span[1]) this.play(false);
      else requestAnimationFrame(frame);
    };
    if (wanted) requestAnimationFrame(frame);
  }

  speed() { return Number(get("speed").value); }

  stepRows(count) {
    this.play(false);
    const row = Math.min(Math.max(rowAt(this.t, this.time) + count, 0), this.t.length - 1);
    this.move(this.t[row]);
  }

  toImpact(direction) {
    const later = this.impacts.filter((t) => (direction > 0 ? t > this.time : t < this.time));
    if (later.length) this.seek(direction > 0 ? later[0] : later[later.length - 1]);
  }

  seek(time) {
    this.play(false);
    this.move(time);
  }

  move(time) {
    this.time = Math.min(Math.max(time, this.run.span[0]), this.run.span[1]);
    this.draw();
  }

  zoom([low, high]) {
    const least = 1e-9 * (this.whole[1] - this.whole[0]);
    this.range = [Math.max(low, this.whole[0]), Math.min(Math.max(high, low + least), this.whole[1])];
    this.plots.show(this.range);
    if (this.timeline) this.timeline.show(this.range);
    const digits = digitsOf(this.range, (this.range[1] - this.range[0]) / 100, 4);
    get("shown").textContent = this.range.map((end) => written(end, "s", digits)).join(" to ");
    this.draw();
  }

  scale(factor) {
    const inside = this.time >= this.range[0] && this.time <= this.range[1];
    const centre = inside ? this.time : (this.range[0] + this.range[1]) / 2;
    this.zoom(this.range.map((end) => centre + factor * (end - centre)));
  }

  pan(part) {
    const width = this.range[1] - this.range[0];
    const low = Math.min(Math.max(this.range[0] + part * width, this.whole[0]), this.whole[1] - width);
    this.zoom([low, low + width]);
  }

  resize() {
    if (this.scene) this.scene.resize();
    if (this.timeline) this.timeline.resize();
    this.plots.resize();
    this.draw();
  }

  draw() {
    const flash = this.pace * this.speed() * FLASH;
    if (this.scene) this.scene.draw(this.time, this.time - flash);
    if (this.timeline && this.timeline.range) this.timeline.draw(this.time);
    this.plots.head(this.time);
    get("time").value = this.time;
    get("clock").textContent = `t = ${written(this.time, "s", this.digits)}`;
    get("pace").textContent = `a second shows ${written(this.pace * this.speed(), "s", 3)}`;
    get("now").textContent = this.sentence(flash);
  }

  // What the contacts do now, in words.
  sentence(flash) {
    const parts = [];
    for (const contact of this.run.contacts) {
      const hit = contact.intervals.find(([start, , code]) => this.run.states[code] === "IMPACT" && start <= this.time && start > this.time - flash);
      const now = contact.intervals.find(([start, end, code]) => this.run.states[code] !== "IMPACT" && start <= this.time && this.time < end);
      const state = hit ? "IMPACT" : now ? this.run.states[now[2]] : "OPEN";
      if (state !== "OPEN" && state !== "HELD") parts.push(`${contact.name}: ${MEANINGS[state]}`);
    }
    if (parts.length > 6) return `${parts.slice(0, 6).join("; ")}; and ${parts.length - 6} more.`;
    return parts.length ? `${parts.join("; ")}.` : this.run.contacts.length ? "No contact is closed." : "";
  }
}

function impactsOf(run) {
  const times = new Set();
  for (const contact of run.contacts)
    for (const [start, , code] of contact.intervals) if (run.states[code] === "IMPACT") times.add(start);
  return [...times].sort((a, b) => a - b);
}

// Each change of a contact, {time, names, what}; contacts that do the same at once are named together.
function eventsOf(run) {
  const events = [];
  for (const contact of run.contacts)
    contact.intervals.forEach(([time, , code, impulse], k) => {
      const state = run.states[code], [before, after] = [-1, 1].map((step) => run.states[contact.intervals[k + step]?.[2]]);
      if (state === "HELD" || (k === 0 && state === "OPEN") || before === "IMPACT") return; // what follows an impact it says
      events.push({ time, names: [contact.name], what: state === "IMPACT" ? "hits" : BECOMES[state], then: after && state === "IMPACT" ? AFTER[after] : "", impulse });
    });
  events.sort((a, b) => a.time - b.time || (a.what < b.what ? -1 : a.what > b.what ? 1 : 0));
  return events.reduce((all, event) => {
    const last = all[all.length - 1];
    const same = last && last.time === event.time && last.what === event.what && last.then === event.then;
    if (!same) all.push(event);
    else Object.assign(last, { names: [...last.names, ...event.names], impulse: (last.impulse || 0) + (event.impulse || 0) });
    return all;
  }, []);
}

function eventRow(event, digits, seek) {
  const row = document.createElement("tr"), button = document.createElement("button");
  button.type = "button";
  button.textContent = written(event.time, "s", digits);
  button.addEventListener("click", () => seek(event.time));
  const impulse = event.impulse ? ` with ${written(event.impulse, "N s", 3)}${event.names.length > 1 ? " together" : ""}` : "";
  const what = [event.what + impulse, event.then];
  for (const content of [button, event.names.join(", "), what.filter(Boolean).join(", ")]) {
    const cell = document.createElement("td");
    cell.append(content);
    row.append(cell);
  }
  return row;
}

function facts(list, pairs, inline) {
  for (const [what, value] of pairs) {
    const term = document.createElement("dt"), text = document.createElement("dd");
    term.textContent = what;
    text.textContent = value;
    if (!inline) { list.append(term, text); continue; }
    const group = document.createElement("div");
    group.append(term, text);
    list.append(group);
  }
}

function legend(list, states) {
  for (const state of states) list.append(legendItem(`var(--${state.toLowerCase()})`, MEANINGS[state]));
}

function arrowLegend(list, largest) {
  if (largest.force > 0) list.append(legendItem("var(--force)", `force λ, longest ${written(largest.force, "N")}`));
  if (largest.impulse > 0) list.append(legendItem("var(--impulse)", `impulse Λ, longest ${written(largest.impulse, "N s")}`));
}

function legendItem(tone, text) {
  const item = document.createElement("li"), mark = document.createElement("span");
  mark.style.background = tone;
  item.append(mark, text);
  return item;
}

function choice(name, tone, plots) {
  const label = document.createElement("label"), box = document.createElement("input"), text = document.createElement("span");
  box.type = "checkbox";
  box.checked = plots.shown.has(name);
  box.addEventListener("change", () => plots.choose(name, box.checked));
  text.textContent = ` ${name}`;
  text.style.borderBottom = `3px solid ${tone}`;
  label.append(box, text);
  return label;
}

readRun().then((run) => { window.saltusPage = new Page(run); });
