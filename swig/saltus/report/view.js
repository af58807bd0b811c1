// From space to the screen: along z for plane runs, in perspective for others; dragged, turned and zoomed by the pointer.
class View {
  constructor(canvas, bounds, spatial, changed) {
    this.canvas = canvas;
    this.spatial = spatial;
    this.centre = bounds[0].map((low, k) => (low + bounds[1][k]) / 2);
    const size = bounds[0].map((low, k) => bounds[1][k] - low);
    this.size = size;
    this.radius = Math.max(Math.hypot(...size) / 2, 1e-12);
    this.changed = changed;
    this.fit();
    this.listen();
  }

  fit() {
    this.azimuth = this.spatial ? -0.9 : -Math.PI / 2;
    this.elevation = this.spatial ? 0.42 : Math.PI / 2;
    this.zoom = 1;
    this.shift = [0, 0];
  }

  resize() {
    const ratio = window.devicePixelRatio || 1;
    this.width = this.canvas.clientWidth;
    this.height = this.wantedHeight();
    this.canvas.style.height = `${this.height}px`;
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.context = this.canvas.getContext("2d");
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  // No higher than what there is to see, with room for names and arrows.
  wantedHeight() {
    const most = Math.min(0.6 * window.innerHeight, 460);
    return this.spatial ? most : Math.min(Math.max((1.15 * this.width * this.size[1]) / this.size[0] || 0, 200), most);
  }

  // To be called before the points of a picture.
  begin() {
    const [sa, ca, se, ce] = [Math.sin(this.azimuth), Math.cos(this.azimuth), Math.sin(this.elevation), Math.cos(this.elevation)];
    this.right = [-sa, ca, 0];
    this.up = [-se * ca, -se * sa, ce];
    this.toViewer = [ce * ca, ce * sa, se];
    const margin = 0.86;
    const fit = this.spatial
      ? Math.min(this.width, this.height) / (2 * this.radius)
      : Math.min(this.width / Math.max(this.size[0], 0.02 * this.radius), this.height / Math.max(this.size[1], 0.02 * this.radius));
    this.scale = margin * fit * this.zoom;
    this.distance = 5 * this.radius;
  }

  // [x, y on the screen, depth towards the viewer, pixels a metre there]
  project(x, y, z) {
    const d = [x - this.centre[0], y - this.centre[1], z - this.centre[2]];
    const depth = dot(d, this.toViewer);
    const scale = this.spatial ? this.scale / Math.max(1 - depth / this.distance, 0.05) : this.scale;
    return [
      this.width / 2 + this.shift[0] + scale * dot(d, this.right),
      this.height / 2 + this.shift[1] - scale * dot(d, this.up),
      depth,
      scale,
    ];
  }

  listen() {
    const pointers = new Map();
    const canvas = this.canvas;
    canvas.addEventListener("pointerdown", (event) => {
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
      canvas.setPointerCapture(event.pointerId);
    });
    const end = (event) => pointers.delete(event.pointerId);
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("pointermove", (event) => {
      if (!pointers.has(event.pointerId)) return;
      const [x, y] = pointers.get(event.pointerId);
      const before = spread(pointers);
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
      if (pointers.size > 1) this.zoom *= spread(pointers) / (before || 1);
      else this.move(event.clientX - x, event.clientY - y, event.shiftKey);
      this.changed();
    });
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom *= Math.exp(-0.0015 * event.deltaY);
      this.changed();
    }, { passive: false });
  }

  move(dx, dy, pan) {
    if (this.spatial && !pan) {
      this.azimuth -= 0.008 * dx;
      this.elevation = Math.min(Math.max(this.elevation + 0.008 * dy, -1.55), 1.55);
    } else {
      this.shift = [this.shift[0] + dx, this.shift[1] + dy];
    }
  }
}

function spread(pointers) {
  const [a, b] = [...pointers.values()];
  return b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
