// The animation: shapes at any time between the rows, contacts, and arrows of what acts in them.
class SceneView {
  constructor(run, canvas, changed) {
    this.run = run;
    this.view = new View(canvas, run.bounds, run.spatial, changed);
    this.shapes = run.shapes.map((shape, k) => ({
      ...shape,
      points: run.values[`points${k}`],
      lines: run.values[`lines${k}`],
      faces: run.values[`faces${k}`],
      poses: run.values[`poses${k}`],
    }));
    this.names = true;
  }

  resize() { this.view.resize(); }

  // At a time; impulses that acted since `since` are still shown.
  draw(time, since) {
    const { view, run } = this, context = view.context, t = run.values.t;
    context.clearRect(0, 0, view.width, view.height);
    view.begin();
    const row = rowAt(t, time), next = Math.min(row + 1, t.length - 1);
    const part = t[next] > t[row] ? (time - t[row]) / (t[next] - t[row]) : 0;
    this.drawShapes(row, next, part);
    this.drawContacts(row, since);
  }

  drawShapes(row, next, part) {
    const pieces = [];
    for (const shape of this.shapes) {
      const placed = place(shape, row, next, part);
      const seen = project(this.view, placed);
      const tone = shape.system < 0 ? colour("scenery") : paletteColour(shape.system);
      if (!this.run.spatial) {
        flat(this.view.context, seen, shape, tone);
        continue;
      }
      const solids = shape.kind === "Sphere" ? [sphere(this.view, placed, seen, shape, tone)] : solid(seen, placed, shape, tone, this.view);
      for (const piece of solids) pieces.push({ ...piece, scenery: shape.system < 0 });
    }
    // scenery first: its large faces have no one depth
    pieces.sort((a, b) => b.scenery - a.scenery || a.depth - b.depth);
    for (const piece of pieces) piece.draw(this.view.context);
  }

  drawContacts(row, since) {
    const start = this.run.values.arrow_start, first = rowAt(this.run.values.t, since);
    for (let k = start[row]; k < start[row + 1]; ++k) this.marker(k);
    for (let k = start[row]; k < start[row + 1]; ++k) this.arrow(k, "force");
    for (let earlier = first + 1; earlier <= row; ++earlier)
      for (let k = start[earlier]; k < start[earlier + 1]; ++k) this.arrow(k, "impulse");
  }

  marker(k) {
    const { values, states, arrow_names } = this.run, context = this.view.context;
    const [x, y] = this.view.project(...entry(values.arrow_point, k));
    const state = states[values.arrow_state[k]].toLowerCase();
    context.beginPath();
    context.arc(x, y, state === "open" ? 3 : 6, 0, 2 * Math.PI);
    context.strokeStyle = colour("front");
    context.lineWidth = 1;
    if (state !== "open") {
      context.fillStyle = colour(state);
      context.fill();
    }
    context.stroke();
    if (this.names && arrow_names.length <= 12) this.label(arrow_names[values.arrow_contact[k]], k, x, y);
  }

  // Away from the middle of the contacts, so that names of neighbours do not cover each other.
  label(text, k, x, y) {
    const { values } = this.run, context = this.view.context;
    let row = rowAt(values.arrow_start, k), middle = [0, 0], count = 0;
    for (let other = values.arrow_start[row]; other < values.arrow_start[row + 1]; ++other, ++count) {
      const seen = this.view.project(...entry(values.arrow_point, other));
      middle = [middle[0] + seen[0], middle[1] + seen[1]];
    }
    const right = x >= middle[0] / count - 1e-6, below = y > middle[1] / count + 1e-6;
    context.font = "12px system-ui, sans-serif";
    context.fillStyle = colour("front");
    context.textAlign = right ? "left" : "right";
    context.textBaseline = "middle";
    const width = context.measureText(text).width, least = right ? 4 : width + 4;
    const beside = Math.min(Math.max(x + (right ? 10 : -10), least), this.view.width - (right ? width : 0) - 4);
    context.fillText(text, beside, y + (below ? 14 : -14));
  }

  arrow(k, kind) {
    const { values, largest } = this.run;
    const vector = entry(values[`arrow_${kind}`], k), size = Math.hypot(...vector);
    if (!(size > 1e-6 * largest[kind])) return;
    const point = entry(values.arrow_point, k);
    // long enough to be seen, and no longer than a quarter of the picture
    const length = (0.06 + 0.19 * (size / largest[kind])) * Math.min(this.view.width, this.view.height) / this.view.scale;
    const tip = point.map((x, i) => x + (length * vector[i]) / size);
    drawArrow(this.view.context, this.view.project(...point), this.view.project(...tip), colour(kind), kind === "impulse" ? 4 : 2.5);
  }
}

const entry = (values, k) => [values[3 * k], values[3 * k + 1], values[3 * k + 2]];

// Points of a shape in space [x, y, z, ...]
function place(shape, row, next, part) {
  const { points, dimension, poses, pose, moves } = shape, count = points.length / dimension;
  const p = Array.from(poses.subarray(moves ? row * pose : 0, (moves ? row * pose : 0) + pose));
  if (moves && part > 0) {
    const q = poses.subarray(next * pose, next * pose + pose);
    let sign = 1;
    if (pose === 7) sign = p[3] * q[3] + p[4] * q[4] + p[5] * q[5] + p[6] * q[6] < 0 ? -1 : 1;
    for (let i = 0; i < pose; ++i) p[i] += part * ((i >= 3 ? sign : 1) * q[i] - p[i]);
  }
  const [origin, R] = pose === 3 ? turnInPlane(p) : turnInSpace(p);
  const placed = new Float64Array(3 * count);
  for (let k = 0; k < count; ++k) {
    const x = points[dimension * k], y = points[dimension * k + 1], z = dimension === 3 ? points[3 * k + 2] : 0;
    for (let i = 0; i < 3; ++i) placed[3 * k + i] = origin[i] + R[3 * i] * x + R[3 * i + 1] * y + R[3 * i + 2] * z;
  }
  placed.origin = origin;
  return placed;
}

function turnInPlane([x, y, angle]) {
  const c = Math.cos(angle), s = Math.sin(angle);
  return [[x, y, 0], [c, -s, 0, s, c, 0, 0, 0, 1]];
}

function turnInSpace([x, y, z, ...quaternion]) {
  const n = Math.hypot(...quaternion), [w, a, b, c] = quaternion.map((e) => e / n);
  return [[x, y, z], [
    1 - 2 * (b * b + c * c), 2 * (a * b - w * c), 2 * (a * c + w * b),
    2 * (a * b + w * c), 1 - 2 * (a * a + c * c), 2 * (b * c - w * a),
    2 * (a * c - w * b), 2 * (b * c + w * a), 1 - 2 * (a * a + b * b),
  ]];
}

function project(view, placed) {
  const seen = [];
  for (let k = 0; k < placed.length; k += 3) seen.push(view.project(placed[k], placed[k + 1], placed[k + 2]));
  return seen;
}

// A plane shape: all faces filled at once, then its lines.
function flat(context, seen, { faces, lines }, tone) {
  context.beginPath();
  for (let k = 0; k < faces.length; k += 3) {
    context.moveTo(seen[faces[k]][0], seen[faces[k]][1]);
    context.lineTo(seen[faces[k + 1]][0], seen[faces[k + 1]][1]);
    context.lineTo(seen[faces[k + 2]][0], seen[faces[k + 2]][1]);
    context.closePath();
  }
  context.globalAlpha = 0.25;
  context.fillStyle = tone;
  context.fill();
  context.globalAlpha = 1;
  drawLines(context, seen, lines, tone, 2);
}

function drawLines(context, seen, lines, tone, width) {
  context.beginPath();
  for (let k = 0; k < lines.length; k += 2) {
    context.moveTo(seen[lines[k]][0], seen[lines[k]][1]);
    context.lineTo(seen[lines[k + 1]][0], seen[lines[k + 1]][1]);
  }
  context.strokeStyle = tone;
  context.lineWidth = width;
  context.lineCap = "round";
  context.stroke();
}

// Faces of a solid that look at the viewer, and its lines, each with its depth.
function solid(seen, placed, { faces, lines }, tone, view) {
  const pieces = [];
  for (let k = 0; k < faces.length; k += 3) {
    const [a, b, c] = [faces[k], faces[k + 1], faces[k + 2]];
    const turned = (seen[b][0] - seen[a][0]) * (seen[c][1] - seen[a][1]) - (seen[b][1] - seen[a][1]) * (seen[c][0] - seen[a][0]);
    const light = lightOn(placed, a, b, c, view, turned > 0);
    pieces.push({
      depth: (seen[a][2] + seen[b][2] + seen[c][2]) / 3,
      draw(context) {
        context.beginPath();
        for (const corner of [a, b, c]) context.lineTo(seen[corner][0], seen[corner][1]);
        context.closePath();
        context.fillStyle = context.strokeStyle = shaded(tone, light);
        context.lineWidth = 0.6; // closes the seams between faces
        context.fill();
        context.stroke();
      },
    });
  }
  for (let k = 0; k < lines.length; k += 2) {
    const [a, b] = [seen[lines[k]], seen[lines[k + 1]]];
    pieces.push({
      depth: (a[2] + b[2]) / 2 + 0.004 * view.radius, // in front of the faces it bounds
      draw(context) {
        context.beginPath();
        context.moveTo(a[0], a[1]);
        context.lineTo(b[0], b[1]);
        context.strokeStyle = shaded(tone, faces.length ? 0.45 : 0.8);
        context.lineWidth = faces.length ? 1 : 2;
        context.stroke();
      },
    });
  }
  return pieces;
}

function lightOn(placed, a, b, c, view, away) {
  const u = [0, 1, 2].map((i) => placed[3 * b + i] - placed[3 * a + i]);
  const v = [0, 1, 2].map((i) => placed[3 * c + i] - placed[3 * a + i]);
  const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const lamp = [0, 1, 2].map((i) => view.toViewer[i] + 0.6 * view.up[i] - 0.4 * view.right[i]);
  const size = Math.hypot(...n) * Math.hypot(...lamp) || 1;
  return 0.55 + 0.45 * Math.max((away ? -1 : 1) * dot(n, lamp) / size, 0);
}

// A sphere is a shaded disc with those parts of its great circles that are in front.
function sphere(view, placed, seen, { lines }, tone) {
  const [x, y, depth, scale] = view.project(...placed.origin);
  const radius = scale * Math.hypot(...[0, 1, 2].map((i) => placed[i] - placed.origin[i]));
  return {
    depth,
    draw(context) {
      const glow = context.createRadialGradient(x - 0.35 * radius, y - 0.45 * radius, 0.1 * radius, x, y, radius);
      glow.addColorStop(0, shaded(tone, 1.25));
      glow.addColorStop(1, shaded(tone, 0.6));
      context.beginPath();
      context.arc(x, y, radius, 0, 2 * Math.PI);
      context.fillStyle = glow;
      context.fill();
      context.beginPath();
      for (let k = 0; k < lines.length; k += 2) {
        const [a, b] = [seen[lines[k]], seen[lines[k + 1]]];
        if (a[2] < depth || b[2] < depth) continue;
        context.moveTo(a[0], a[1]);
        context.lineTo(b[0], b[1]);
      }
      context.strokeStyle = shaded(tone, 0.35);
      context.lineWidth = 1.2;
      context.stroke();
    },
  };
}

function shaded(tone, light) {
  const parts = [1, 3, 5].map((k) => Math.min(Math.round(parseInt(tone.slice(k, k + 2), 16) * light), 255));
  return `rgb(${parts.join(",")})`;
}

function drawArrow(context, from, to, tone, width) {
  const dx = to[0] - from[0], dy = to[1] - from[1], length = Math.hypot(dx, dy);
  if (length < 1) return;
  const head = Math.min(4 * width, 0.6 * length), [ux, uy] = [dx / length, dy / length];
  context.strokeStyle = context.fillStyle = tone;
  context.lineWidth = width;
  context.beginPath();
  context.moveTo(from[0], from[1]);
  context.lineTo(to[0] - head * ux, to[1] - head * uy);
  context.stroke();
  context.beginPath();
  context.moveTo(to[0], to[1]);
  context.lineTo(to[0] - head * ux - 0.5 * head * uy, to[1] - head * uy + 0.5 * head * ux);
  context.lineTo(to[0] - head * ux + 0.5 * head * uy, to[1] - head * uy - 0.5 * head * ux);
  context.fill();
}
