"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
const dark = matchMedia("(prefers-color-scheme: dark)");
const byId = (id) => document.getElementById(id);
const [play, slider, now, speed] = ["play", "time", "now", "speed"].map(byId);
const curves = Object.keys(data.figures).filter((id) => id !== "arm");

function themed(value) {
  if (typeof value === "string") {
    return (dark.matches && data.dark[value]) || value;
  }
  if (Array.isArray(value)) {
    return typeof value[0] === "number" ? value : value.map(themed);
  }
  return value && typeof value === "object"
    ? Object.fromEntries(Object.entries(value).map(([key, part]) => [key, themed(part)]))
    : value;
}

function draw() {
  for (const [id, figure] of Object.entries(data.figures)) {
    const { data: traces, layout } = themed(figure);
    const config = { displayModeBar: false, responsive: true };
    Plotly.react(byId(id), traces, layout, config);
  }
  show();
}

// the arm at the slider's frame, and a line there in every curve
function show() {
  const k = Number(slider.value);
  const t = data.times[k];
  now.value = `${t.toFixed(2)} s`;
  const axes = ["x", "y", "z"].slice(0, data.moves[0][0].length);
  const moved = Object.fromEntries(axes.map((axis, i) => [axis, data.moves.map((m) => m[k][i])]));
  Plotly.restyle(byId("arm"), moved, data.moves.map((_, i) => i));
  const line = { type: "line", x0: t, x1: t, y0: 0, y1: 1, yref: "paper",
                 line: { width: 1, dash: "dot", color: dark.matches ? "#a3adb8" : "#5d6875" } };
  for (const id of curves) {
    Plotly.relayout(byId(id), { shapes: [line] });
  }
}

let running = null;

function stop() {
  running = null;
  play.textContent = "Play";
}

function run() {
  if (Number(slider.value) >= data.times.length - 1) {
    slider.value = 0;
  }
  const mine = {};
  running = mine;
  play.textContent = "Pause";
  let start = null;
  const from = data.times[Number(slider.value)];
  const frame = (clock) => {
    if (running !== mine) {
      return;
    }
    start ??= clock;
    const t = from + ((clock - start) / 1000) * Number(speed.value);
    let k = data.times.findIndex((x) => x >= t);
    if (k < 0) {
      k = data.times.length - 1;
    }
    slider.value = k;
    show();
    if (k === data.times.length - 1) {
      stop();
    } else {
      requestAnimationFrame(frame);
    }
  };
  requestAnimationFrame(frame);
}

play.addEventListener("click", () => (running ? stop() : run()));
slider.addEventListener("input", () => {
  stop();
  show();
});
speed.addEventListener("change", () => running && run());
dark.addEventListener("change", draw);
draw();
