"use strict";
// The run: texts from #run, arrays from #numbers.
const TYPED = { float32: Float32Array, float64: Float64Array, uint8: Uint8Array, uint16: Uint16Array, uint32: Uint32Array };

async function readRun() {
  const run = JSON.parse(document.getElementById("run").textContent);
  const packed = Uint8Array.from(atob(document.getElementById("numbers").textContent.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const buffer = await new Response(stream).arrayBuffer();
  run.values = {};
  for (const [name, [type, offset, length]] of Object.entries(run.arrays))
    run.values[name] = new TYPED[type](buffer, offset, length);
  return run;
}

// The last row at or before a time.
function rowAt(t, time) {
  let low = 0, high = t.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (t[middle] <= time) low = middle; else high = middle - 1;
  }
  return low;
}

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

const PALETTE = ["#3b76af", "#e07b39", "#4f9d5b", "#c44e52", "#8172b3", "#937860", "#d687bd", "#7f8a93", "#b6a83a", "#4fb0c6"];
const paletteColour = (k) => PALETTE[k % PALETTE.length];

// As many digits as tell times in this range apart that differ by so much.
function digitsOf([low, high], difference, least) {
  const size = Math.max(Math.abs(low), Math.abs(high));
  return difference > 0 ? Math.min(Math.max(Math.ceil(Math.log10(size / difference)) + 1, least), 15) : least;
}

// A number with unit that people can read: 1.23e-5 s, 0.0042 m
function written(value, unit, digits = 4) {
  if (value === null) return `? ${unit}`; // not finite
  if (value === 0) return `0 ${unit}`;
  const size = Math.abs(value);
  const rounded = Number(value.toPrecision(digits));
  return `${size < 1e-3 || size >= 1e5 ? rounded.toExponential() : rounded} ${unit}`;
}
