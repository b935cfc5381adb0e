"use strict";
// Draws the figures, follows light and dark, and moves pictures through poses computed beforehand.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const live = data.live;
  const $ = (id) => document.getElementById(id);
  const night = matchMedia("(prefers-color-scheme: dark)");
  const narrow = () => innerWidth < 760;
  const config = { displayModeBar: false, responsive: true, scrollZoom: false };
  let printing = false;

  // -- numbers ---------------------------------------------------------------------------------

  const minus = (text) => text.replace("e-0", "e-").replaceAll("-", "−");

  function number(x) {
    if (!Number.isFinite(x)) return "∞";
    const a = Math.abs(x);
    if (a < 1e-12) return "0";
    return minus(a < 1e-4 || a >= 1e5 ? x.toExponential(2) : String(+x.toPrecision(3)));
  }

  function cells(rows) {
    const top = Math.max(...rows.flat().map(Math.abs));
    const decimals = Math.min(Math.max(2 - Math.floor(Math.log10(top || 1)), 0), 6);
    const text = (v) => {
      const a = Math.abs(v);
      if (a <= 1e-7 * top) return "0"; // single precision
      if (a < 1e-3 * top) return "≈0";
      return minus(a >= 10 ** -decimals ? v.toFixed(decimals) : String(+v.toPrecision(1)));
    };
    return rows.map((row) => row.map(text));
  }

  // {shape, f4} to a function of indices that gives a number or the flat rest
  function unpack({ shape, f4 }) {
    const bytes = Uint8Array.from(atob(f4), (c) => c.charCodeAt(0));
    const values = new Float32Array(bytes.buffer);
    const strides = shape.map((_, k) => shape.slice(k + 1).reduce((a, b) => a * b, 1));
    const at = (...index) => {
      const start = index.reduce((sum, i, k) => sum + i * strides[k], 0);
      if (index.length === shape.length) return values[start];
      return Array.from(values.subarray(start, start + strides[index.length - 1]));
    };
    return Object.assign(at, { shape, all: Array.from(values) });
  }

  const rowsOf = (flat, width) =>
    Array.from({ length: flat.length / width }, (_, k) => flat.slice(k * width, (k + 1) * width));

  const cache = new Map();
  const array = (held, key) => {
    if (!cache.has(held)) cache.set(held, {});
    const known = cache.get(held);
    return (known[key] ??= unpack(held[key]));
  };

  const triangle = (i, j, n) => {
    const [a, b] = i < j ? [i, j] : [j, i];
    return (a * (2 * n - a - 1)) / 2 + b;
  };

  // -- drawing ---------------------------------------------------------------------------------

  function inked(x) {
    const dark = night.matches && !printing;
    if (typeof x === "string") return (dark && data.dark[x]) || x;
    if (Array.isArray(x)) return x.map(inked);
    if (x && typeof x === "object") {
      return Object.fromEntries(Object.entries(x).map(([k, v]) => [k, inked(v)]));
    }
    return x;
  }

  function draw(div) {
    const { data: traces, layout } = inked(data.figures[div.dataset.figure]);
    if (narrow()) {
      layout.font.size = 12;
      if (layout.scene) {
        layout.height = 380;
        for (const axis of "xyz") layout.scene.aspectratio[axis] *= 0.85;
      }
      if (traces[0].texttemplate && live.n > 4) traces[0].textfont.size = 9;
    }
    div.style.height = `${layout.height}px`;
    div.shown = "start";
    return Plotly.react(div, traces, layout, config);
  }

  const plots = [...document.querySelectorAll("[data-figure]")];

  const seek = (div, test) => div.data.flatMap((trace, k) => (test(trace.meta || {}) ? [k] : []));
  const unit = (i, j) => {
    const slides = [i, j].filter((k) => live.effortUnits[k] === "N").length;
    return ["kg·m²", "kg·m", "kg"][slides];
  };

  // -- one joint moves -------------------------------------------------------------------------

  let swept, place = 0;

  function moveArm(k) {
    const div = $("arm");
    const points = array(swept, "points");
    const size = points.shape[2];
    const P = rowsOf(points(k), size);
    const axes = rowsOf(array(swept, "axes")(k), size);
    const change = { x: [], y: [], z: [] };
    const which = [];
    const put = (trace, coordinates) => {
      which.push(trace);
      ["x", "y", "z"].slice(0, size).forEach((axis, c) => change[axis].push(coordinates(c)));
    };
    div.data.forEach(({ meta }, trace) => {
      if (meta?.points) put(trace, (c) => meta.points.map((p) => (p === null ? null : P[p][c])));
      const center = P[meta?.ellipse ?? meta?.ellipsoid];
      if (!center) return;
      const unitShape = array(live, size === 2 ? "circle" : "ball");
      const skin = (c) =>
        rowsOf(unitShape.all, size).map((u) =>
          u.reduce((sum, part, a) => sum + part * axes[a][c], center[c]));
      put(trace, (c) => (size === 2 ? skin(c) : rowsOf(skin(c), unitShape.shape[1])));
    });
    if (size === 2) delete change.z;
    return Plotly.restyle(div, change, which);
  }

  function matrix(k) {
    const flat = array(swept, "M")(k);
    const n = live.n;
    return Array.from({ length: n }, (_, i) =>
      Array.from({ length: n }, (_, j) => flat[triangle(i, j, n)]));
  }

  function moveMatrix(k) {
    const z = matrix(k);
    const top = Math.max(...array(swept, "M").all.map(Math.abs));
    const change = { z: [z], zmin: -top, zmax: top };
    if ($("M").data[0].texttemplate) change.text = [cells(z)];
    return Plotly.restyle($("M"), change, [0]);
  }

  const moveGravity = (k) => {
    const traces = seek($("holding"), (meta) => meta.role === "now");
    return Plotly.restyle($("holding"), { x: [array(swept, "g")(k)] }, traces);
  };

  function values(role, k, i) {
    const n = live.n;
    if (role === "locked") return array(swept, "M")(k)[triangle(i, i, n)];
    if (role === "condition") return array(swept, "condition")(k);
    return array(swept, role)(k, i);
  }

  const column = (role, i) =>
    Array.from({ length: array(swept, "at").shape[0] }, (_, k) => values(role, k, i));

  function moveCurves(k) {
    const div = $("curves");
    const at = array(swept, "at")(k);
    const which = seek(div, (meta) => meta.here);
    const y = which.map((t) => [values(div.data[t].meta.here, k, looked())]);
    const x = which.map(() => [at]);
    return Plotly.update(div, { x, y }, { "shapes[0].x0": at, "shapes[0].x1": at }, which);
  }

  function newCurves() {
    const div = $("curves");
    const x = array(swept, "at").all;
    const i = looked();
    const j = swept.joint;
    const lines = seek(div, (meta) => meta.curve);
    const ends = seek(div, (meta) => meta.extremes);
    const locked = column("locked", i);
    const at = [Math.min, Math.max].map((pick) => locked.indexOf(pick(...locked)));
    const change = {
      x: [...lines.map(() => x), at.map((k) => x[k])],
      y: [...lines.map((t) => column(div.data[t].meta.curve, i)), at.map((k) => locked[k])],
    };
    const titles = {
      "xaxis.title.text": `${live.labels[j]} [${live.units[j]}]`,
      "annotations[0].text": `inertia felt by ${live.labels[i]} [${unit(i, i)}]`,
      "annotations[1].text": `holding effort of ${live.labels[i]} [${live.effortUnits[i]}]`,
      ...Object.assign({}, ...rangesOf(i)),
    };
    return Plotly.update(div, change, titles, [...lines, ...ends]);
  }

  // what changes by rounding only must look flat
  const rangesOf = (i) =>
    ["g", "condition"].map((role, k) => {
      const y = column(role, i);
      const [low, high] = [Math.min(...y), Math.max(...y)];
      const axis = `yaxis${k + 2}`;
      const flat = high - low <= 1e-5 * Math.max(Math.abs(low), Math.abs(high), 1e-6);
      if (!flat) return { [`${axis}.autorange`]: true };
      return { [`${axis}.autorange`]: false, [`${axis}.range`]: [low - 1, high + 1] };
    });

  const looked = () => +$("look").value;

  function say(k) {
    const [i, j] = [looked(), swept.joint];
    const at = `${live.names[j]} = ${number(array(swept, "at")(k))} ${live.units[j]}`;
    const [locked, free] = ["locked", "free"].map((role) => number(values(role, k, i)));
    const held = `${number(values("g", k, i))} ${live.effortUnits[i]}`;
    $("where").textContent = `${number(array(swept, "at")(k))} ${live.units[j]}`;
    $("position").setAttribute("aria-valuetext", at);
    $("said").textContent =
      `At ${at}, ${live.names[i]} feels ${locked} ${unit(i, i)} with the others locked, ` +
      `${free} with them free; holding it still takes ${held}.`;
  }

  let waiting = false;

  async function follow() {
    waiting = false;
    const k = place;
    say(k);
    const pose = k === swept.start ? "start" : `${swept.joint}:${k}`;
    if ($("arm").shown !== pose) {
      $("arm").shown = pose; // 3D is slow where there is no graphics card
      await moveArm(k);
    }
    await Promise.all([moveMatrix(k), moveGravity(k), moveCurves(k)]);
    document.body.dataset.place = `${swept.joint}:${k}`;
  }

  function goTo(k) {
    place = k;
    $("position").value = k;
    if (!waiting) requestAnimationFrame(follow);
    waiting = true;
  }

  function take(j) {
    swept = live.sweeps.find((s) => s.joint === j);
    $("position").max = array(swept, "at").shape[0] - 1;
    $("position").value = place = swept.start;
  }

  async function choose(j) {
    take(j);
    await newCurves();
    goTo(swept.start);
  }

  function toExtreme(pick) {
    const locked = column("locked", looked());
    goTo(locked.indexOf(pick(...locked)));
  }

  function listen() {
    $("joint").addEventListener("change", (event) => choose(+event.target.value));
    $("position").addEventListener("input", (event) => goTo(+event.target.value));
    $("look").addEventListener("change", async () => {
      await newCurves();
      goTo(place);
    });
    $("back").addEventListener("click", () => goTo(swept.start));
    $("least").addEventListener("click", () => toExtreme(Math.min));
    $("most").addEventListener("click", () => toExtreme(Math.max));
  }

  // -- one entry of M --------------------------------------------------------------------------

  function showEntry() {
    const [i, j] = [+$("row").value, +$("column").value];
    const n = live.n;
    const div = $("entry");
    const links = (key) => {
      const part = array(live, key);
      return Array.from({ length: part.shape[0] }, (_, k) => part(k)[triangle(i, j, n)]);
    };
    const x = [
      [...links("translation"), null],
      [...links("rotation"), null],
      [...links("rotation").fill(null), i === j ? array(live, "armature")(i) : 0],
    ];
    return Plotly.update(div, { x }, { "xaxis.title.text": unit(i, j) }, [0, 1, 2]);
  }

  // -- two joints ------------------------------------------------------------------------------

  function showMap() {
    const div = $("map");
    const map = live.maps[+$("pair").value];
    const [what, k] = $("quantity").value.split(":");
    const z = what === "condition" ? array(map, what).all : array(map, what)(+k);
    const [x, y] = [array(map, "x").all, array(map, "y").all];
    const [low, high] = [Math.min(...z), Math.max(...z)];
    const flat = high - low <= 1e-5 * Math.max(Math.abs(high), Math.abs(low), 1e-9);
    const [a, b] = map.joints;
    const off = (e) => // from the explained pose, in shares of the ranges
      ((x[Math.floor(e / y.length)] - live.q[a]) / (x.at(-1) - x[0])) ** 2 +
      ((y[e % y.length] - live.q[b]) / (y.at(-1) - y[0])) ** 2;
    const nearest = (v) => z.reduce(
      (best, w, e) =>
        Math.abs(w - v) <= 1e-5 * (high - low) && (best < 0 || off(e) < off(best)) ? e : best,
      -1);
    const ends = flat ? [] : [low, high].map(nearest);
    const edges = (grid) => {
      const half = (grid[1] - grid[0]) / 2;
      return [grid[0] - half, grid.at(-1) + half];
    };
    const i = live.shown[+k];
    const units = { felt: unit(i, i), g: live.effortUnits[i], condition: "" };
    const change = {
      x: [x, ends.map((e) => x[Math.floor(e / y.length)]), [live.q[a]]],
      y: [y, ends.map((e) => y[e % y.length]), [live.q[b]]],
    };
    const rows = rowsOf(z, y.length);
    const heat = {
      z: [y.map((_, r) => rows.map((row) => row[r]))],
      zmin: flat ? low - 1 : low,
      zmax: flat ? high + 1 : high,
      "colorbar.title.text": units[what],
    };
    const titles = {
      "xaxis.title.text": `${live.labels[a]} [${live.units[a]}]`,
      "yaxis.title.text": `${live.labels[b]} [${live.units[b]}]`,
      "xaxis.range": edges(x),
      "yaxis.range": edges(y),
    };
    const place = (e) =>
      `${live.names[a]} = ${number(x[Math.floor(e / y.length)])}, ` +
      `${live.names[b]} = ${number(y[e % y.length])}`;
    $("extremes").textContent = flat
      ? `The same everywhere: ${number(low)} ${units[what]}.`
      : `Least ${number(low)} ${units[what]} at ${place(ends[0])}; ` +
        `most ${number(high)} ${units[what]} at ${place(ends[1])}.`;
    return Plotly.update(div, change, titles, [0, 1, 2]).then(() =>
      Plotly.restyle(div, heat, [0]));
  }

  const also = [];
  function wire(ids, show) {
    if (!ids.every($)) return;
    ids.forEach((id) => $(id).addEventListener("change", show));
    also.push(show);
  }

  // -- start -----------------------------------------------------------------------------------

  async function refresh() {
    for (const div of plots) await draw(div);
    if (swept) {
      await newCurves();
      await follow();
    }
    for (const show of also) await show();
  }

  async function start() {
    wire(["row", "column"], showEntry);
    wire(["pair", "quantity"], showMap);
    if ($("joint")) {
      listen();
      take(+$("joint").value);
    }
    await refresh();
    night.addEventListener("change", refresh);
    addEventListener("beforeprint", () => {
      document.querySelectorAll("details").forEach((d) => { d.open = true; });
      printing = true;
      refresh();
    });
    addEventListener("afterprint", () => { printing = false; refresh(); });
    document.body.dataset.ready = "yes";
  }

  start();
})();
