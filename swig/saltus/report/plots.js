// Plots with a common time axis.
const PLOT_HEIGHT = 190, MOST_IN_LEGEND = 12, MOST_MARKS = 300, FIRST_SHOWN = 6, FLOOR = 1e-18;

class Plots {
  constructor(run, box, impacts, zoomed, seek) {
    this.run = run;
    this.impacts = impacts;
    this.zoomed = zoomed;
    this.seek = seek;
    this.whole = run.span[0] < run.span[1] ? run.span : [run.span[0], run.span[0] + 1];
    this.contacts = run.contacts.map((contact) => contact.name).filter((name) => run.panels.some((p) => p.lines.some((l) => l.contact === name)));
    this.shown = new Set(this.contacts.slice(0, FIRST_SHOWN));
    this.plots = run.panels.map((panel, k) => this.make(panel, k, box));
  }

  make(panel, number, box) {
    const figure = document.createElement("figure"), caption = document.createElement("figcaption"), small = document.createElement("small");
    caption.textContent = `${panel.title} [${panel.unit}] `;
    small.textContent = panel.note;
    caption.append(small);
    const holder = document.createElement("div");
    holder.className = "plot";
    figure.append(caption, holder);
    box.append(figure);
    const data = [Array.from(this.run.values.t), ...panel.lines.map((_, k) => drawable(this.run.values[`panel${number}.${k}`], panel.kind))];
    const plot = new uPlot(this.options(panel, holder), data, holder);
    plot.head = document.createElement("div");
    plot.head.className = "head";
    plot.over.append(plot.head);
    plot.over.addEventListener("click", (event) => {
      if (plot.select.width < 2) this.seek(plot.posToVal(event.offsetX, "x"));
    });
    return plot;
  }

  options(panel, holder) {
    const values = (plot, ticks, number, space, step) => ticks.map((v) => (v === null ? "" : shortNumber(v, panel.kind === "log" && number === 1 ? Math.abs(v) : step)));
    const axis = { values, stroke: () => colour("soft"), grid: { stroke: () => colour("line"), width: 1 }, ticks: { stroke: () => colour("line") } };
    return {
      width: holder.clientWidth || 300,
      height: PLOT_HEIGHT,
      legend: { show: panel.lines.length <= MOST_IN_LEGEND },
      cursor: { sync: { key: "run" }, drag: { x: true, y: false, setScale: false }, focus: { prox: 12 } },
      scales: { x: { time: false, range: (_, low, high) => [low, high] }, y: panel.kind === "log" ? { distr: 3 } : {} },
      axes: [{ ...axis, size: 34, space: 80 }, { ...axis, size: 66 }],
      series: [{ label: "t [s]", value: (_, v) => (v === null ? "" : written(v, "s", 9)) }, ...panel.lines.map((line, k) => this.line(line, k, panel))],
      hooks: {
        drawClear: [(plot) => this.mark(plot)],
        setSelect: [(plot) => {
          if (plot.select.width < 2) return;
          const low = plot.posToVal(plot.select.left, "x"), high = plot.posToVal(plot.select.left + plot.select.width, "x");
          plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
          this.zoomed([low, high]);
        }],
      },
    };
  }

  line(line, k, panel) {
    const index = line.contact ? this.contacts.indexOf(line.contact) : k;
    const stroke = line.contact || panel.lines.length > 1 ? paletteColour(index) : colour("front");
    const series = {
      label: line.label, stroke, width: 1.5, dash: line.row ? [6, 4] : undefined, points: { show: false },
      show: !line.contact || this.shown.has(line.contact),
      value: (_, v) => (v === null || v === undefined ? "–" : written(v, panel.unit)),
    };
    if (panel.kind === "stems") return { ...series, paths: stems, points: { show: true, size: 5, fill: stroke, filter: nonzero } };
    return series;
  }

  // Lines at impacts, below the curves.
  mark(plot) {
    const { min, max } = plot.scales.x, inside = this.impacts.filter((t) => t >= min && t <= max);
    if (inside.length > MOST_MARKS) return;
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.fillStyle = colour("mark");
    for (const t of inside) ctx.fillRect(Math.round(plot.valToPos(t, "x", true)), bbox.top, 1, bbox.height);
    ctx.restore();
  }

  show([low, high]) {
    for (const plot of this.plots) plot.setScale("x", { min: low, max: high });
  }

  head(time) {
    for (const plot of this.plots) {
      const x = plot.valToPos(time, "x"), inside = x >= 0 && x <= plot.over.clientWidth;
      plot.head.style.display = inside ? "block" : "none";
      plot.head.style.height = "100%";
      plot.head.style.transform = `translateX(${x}px)`;
    }
  }

  choose(contact, visible) {
    if (visible) this.shown.add(contact); else this.shown.delete(contact);
    this.run.panels.forEach((panel, k) => panel.lines.forEach((line, i) => {
      if (line.contact === contact) this.plots[k].setSeries(i + 1, { show: visible });
    }));
  }

  resize() {
    for (const plot of this.plots) plot.setSize({ width: plot.root.parentNode.clientWidth, height: PLOT_HEIGHT });
  }
}

function drawable(values, kind) {
  return Array.from(values, (v) => (Number.isFinite(v) ? (kind === "log" ? Math.max(v, FLOOR) : v) : null));
}

// Lines from zero to what is not zero.
function stems(plot, index, first, last) {
  const path = new Path2D(), [t, values] = [plot.data[0], plot.data[index]], zero = plot.valToPos(0, "y", true);
  for (let k = first; k <= last; ++k)
    if (values[k]) {
      const x = plot.valToPos(t[k], "x", true);
      path.moveTo(x, zero);
      path.lineTo(x, plot.valToPos(values[k], "y", true));
    }
  return { stroke: path, fill: null, flags: 0 };
}

function nonzero(plot, index, show) {
  if (!show) return null;
  const values = plot.data[index], kept = [];
  for (let k = 0; k < values.length; ++k) if (values[k]) kept.push(k);
  return kept.length <= 2000 ? kept : null;
}

// With as many digits as tell it from a number that differs by a step.
function shortNumber(value, step) {
  if (Math.abs(value) < 1e-6 * step) return "0";
  return written(value, "", digitsOf([value, value], step / 100, 1)).trim();
}
