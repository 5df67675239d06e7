"use strict";
// Draws the charts of a run's report from the JSON in #data; #status says what was drawn.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const check = location.hash === "#check"; // also look whether the canvases hold ink
  const status = { charts: [], errors: window.hmcdynErrors };
  const frames = data.t.length;
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const finite = (v) => v !== null && Number.isFinite(v);
  const font = "12px system-ui, sans-serif";
  const stagePalette = ["#7aa6c2", "#d9a441", "#6fae8b", "#b07aa1", "#c96f5a", "#8c9bd1", "#a3a380",
    "#d48fb0", "#5f9ea0", "#bb8f5a"];
  const xName = data.x_is_frame ? "frame" : "time (s)";
  const xs = data.x_is_frame ? data.t.map((_, i) => i) : data.t;
  const charts = [];
  const timeCharts = [];

  const number = (v, digits) => (finite(v) ? v.toFixed(digits) : "–");
  const axis = (label, more) => Object.assign({
    label, font, labelFont: font, labelSize: 18, stroke: () => css("--muted"),
    grid: { stroke: () => css("--line"), width: 1 }, ticks: { stroke: () => css("--line"), width: 1 },
  }, more);

  if (check) { // keeps the canvases where they can be read
    const getContext = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, more) {
      return getContext.call(this, kind, Object.assign({ willReadFrequently: true }, more));
    };
  }

  // Pixels of the plot that the series changed, read only for the check.
  function inkHooks(entry) {
    if (!check) return {};
    let before = null;
    const read = (u) => u.ctx.getImageData(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height).data;
    return {
      drawAxes: [(u) => { before = read(u); }],
      draw: [(u) => {
        const after = read(u);
        let ink = 0;
        for (let i = 0; i < after.length; i += 4) {
          if (after[i] !== before[i] || after[i + 1] !== before[i + 1] || after[i + 2] !== before[i + 2] ||
              after[i + 3] !== before[i + 3]) ++ink;
        }
        entry.ink = ink;
      }],
    };
  }

  function place(id) {
    const holder = document.getElementById(id);
    const inner = document.createElement("div");
    holder.appendChild(inner);
    return inner;
  }

  function refuse(id, why) {
    const note = place(id);
    note.className = "empty";
    note.textContent = why;
  }

  function watchSize(u, box, height, after = () => {}) {
    new ResizeObserver(() => {
      const width = Math.max(200, box.clientWidth);
      if (width === u.width) return;
      u.setSize({ width, height: height(width) });
      after();
    }).observe(box);
  }

  function merge(...sets) {
    const all = {};
    for (const set of sets) {
      for (const name of Object.keys(set)) all[name] = (all[name] || []).concat(set[name]);
    }
    return all;
  }

  // ---- Charts over time, whose zoom is shared.
  let sharing = false;
  function shareZoom(u, key) {
    if (key !== "x" || sharing) return;
    sharing = true;
    const { min, max } = u.scales.x;
    for (const other of timeCharts) {
      if (other !== u && (other.scales.x.min !== min || other.scales.x.max !== max)) {
        other.setScale("x", { min, max });
      }
    }
    sharing = false;
  }
  function wholeRange() {
    const first = frames ? xs[0] : 0, last = frames ? xs[frames - 1] : 1;
    return last > first ? [first, last] : [first - 0.5, first + 0.5];
  }
  function zoomTime(factor, shift) {
    if (!timeCharts.length) return;
    const { min, max } = timeCharts[0].scales.x, half = ((max - min) / 2) * factor;
    const middle = (min + max) / 2 + shift * (max - min);
    timeCharts[0].setScale("x", { min: middle - half, max: middle + half });
  }
  function wheelZoom(u) {
    u.over.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !event.shiftKey) return; // the plain wheel scrolls the page
      event.preventDefault();
      zoomTime((event.deltaY || event.deltaX) > 0 ? 1.25 : 0.8, 0);
    }, { passive: false });
  }

  // Frames without a pose, as bands behind the curves.
  function drawLost(u) {
    const ctx = u.ctx;
    ctx.save();
    ctx.beginPath();
    ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    ctx.clip();
    ctx.fillStyle = css("--lost");
    ctx.globalAlpha = 0.16;
    for (let i = 0; i < frames; ++i) {
      if (data.failure[i] < 0) continue;
      const left = u.valToPos(i ? (xs[i - 1] + xs[i]) / 2 : xs[i], "x", true);
      const right = u.valToPos(i + 1 < frames ? (xs[i] + xs[i + 1]) / 2 : xs[i], "x", true);
      ctx.fillRect(left, u.bbox.top, Math.max(1, right - left), u.bbox.height);
    }
    ctx.restore();
  }

  // series: [{name, values, colour (css variable or colour), fill, raw}]
  function timeChart(id, yName, series, more = {}) {
    const points = series.reduce((n, s) => n + s.values.filter(finite).length, 0);
    if (!points) return refuse(id, "Nothing was measured.");
    const entry = { id, series: series.length, points, ink: -1 };
    const box = place(id), height = () => more.height || 230;
    const colour = (c) => (c.startsWith("--") ? css(c) : c);
    const options = {
      width: Math.max(200, box.clientWidth), height: height(),
      cursor: { sync: { key: "time" }, drag: { x: true, y: false }, points: { size: 6 } },
      scales: { x: { time: false, range: (u, a, b) => (a === null || a === b ? wholeRange() : [a, b]) }, y: more.yScale || {} },
      axes: [axis(xName, { size: 34 }), axis(yName, Object.assign({ size: 58 }, more.yAxis))],
      series: [{ label: xName, value: (u, v) => number(v, data.x_is_frame ? 0 : 2) }].concat(series.map((s) => ({
        label: s.name, stroke: () => colour(s.colour), width: s.width === undefined ? 1.5 : s.width,
        fill: s.fill ? () => colour(s.colour) : undefined, paths: s.paths,
        points: s.points || { show: frames < 3, size: 6, fill: () => colour(s.colour) },
        value: (u, v, si, i) => (i === null ? "–" : (s.text ? s.text(i) : number((s.raw || s.values)[i], s.digits === undefined ? 2 : s.digits))),
      }))),
      hooks: merge(inkHooks(entry), { setScale: [shareZoom] }, more.hooks || {}),
    };
    const u = new uPlot(options, [xs].concat(series.map((s) => s.values)), box);
    wheelZoom(u);
    watchSize(u, box, height);
    timeCharts.push(u);
    charts.push(u);
    status.charts.push(entry);
  }

  // Stacked areas: the highest sum is drawn first, the others over it.
  function stacked(id, yName, parts, digits) {
    const sums = [];
    let below = new Array(frames).fill(0);
    for (const part of parts) {
      below = below.map((b, i) => b + (finite(part.values[i]) ? part.values[i] : 0));
      sums.push(below);
    }
    if (!parts.some((part) => part.values.some(finite))) return refuse(id, "Nothing was measured.");
    timeChart(id, yName, parts.map((part, k) => ({ name: part.name, values: sums[k], raw: part.values,
      colour: part.colour, fill: true, width: 0.5, digits })).reverse(), { yScale: { range: (u, a, b) => [0, b > 0 ? b * 1.05 : 1] } });
  }

  // ---- The trajectory, in three views with equal axes.
  function mix(a, b, t) {
    const rgb = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));
    const p = rgb(a), q = rgb(b);
    return "rgb(" + p.map((v, k) => Math.round(v + (q[k] - v) * t)).join(",") + ")";
  }
  function ramp() {
    const [low, middle, high] = ["--low", "--middle", "--high"].map(css), colours = [];
    for (let k = 0; k <= 32; ++k) colours.push(k <= 16 ? mix(low, middle, k / 16) : mix(middle, high, (k - 16) / 16));
    return colours;
  }
  const drawn = (i, p) => finite(p[0][i]) && finite(p[1][i]) && finite(p[2][i]);

  function line(u, a, b, colourOf) {
    const ctx = u.ctx;
    let open = null, last = -2, isolated = [];
    const px = (i) => u.valToPos(a[i], "x", true), py = (i) => u.valToPos(b[i], "y", true);
    for (let i = 0; i < frames; ++i) {
      if (!finite(a[i]) || !finite(b[i])) continue;
      const colour = colourOf(i);
      if (last === i - 1) {
        if (open !== colour) {
          if (open !== null) ctx.stroke();
          ctx.strokeStyle = open = colour;
          ctx.beginPath();
          ctx.moveTo(px(last), py(last));
        }
        ctx.lineTo(px(i), py(i));
      } else if (i + 1 >= frames || !finite(a[i + 1]) || !finite(b[i + 1])) {
        isolated.push(i);
      }
      last = i;
    }
    if (open !== null) ctx.stroke();
    for (const i of isolated) {
      ctx.fillStyle = colourOf(i);
      ctx.fillRect(px(i) - 2, py(i) - 2, 4, 4);
    }
  }

  function drawTrajectory(u, a, b, truth) {
    const ctx = u.ctx, colours = ramp();
    ctx.save();
    ctx.beginPath();
    ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    ctx.clip();
    ctx.lineJoin = ctx.lineCap = "round";
    if (truth) {
      ctx.lineWidth = 1.5 * devicePixelRatio;
      const grey = css("--truth");
      line(u, truth[0], truth[1], () => grey);
    }
    ctx.lineWidth = 2.25 * devicePixelRatio;
    const accent = css("--accent");
    line(u, a, b, (i) => (data.error && finite(data.error[i]) && data.max_error > 0
      ? colours[Math.round((32 * data.error[i]) / data.max_error)] : accent));
    ctx.setLineDash([5, 4]);
    ctx.lineWidth = 1.25 * devicePixelRatio;
    ctx.strokeStyle = accent;
    for (const [i, j] of data.loops) {
      ctx.beginPath();
      ctx.moveTo(u.valToPos(a[i], "x", true), u.valToPos(b[i], "y", true));
      ctx.lineTo(u.valToPos(a[j], "x", true), u.valToPos(b[j], "y", true));
      ctx.stroke();
    }
    ctx.restore();
  }

  function view(id, names, axes, signs) {
    const pick = (p, k) => (p ? p[axes[k]].map((v) => (finite(v) ? signs[k] * v : null)) : null);
    const a = pick(data.p, 0), b = pick(data.p, 1);
    const truth = data.truth ? [pick(data.truth, 0), pick(data.truth, 1)] : null;
    const points = data.p[0].filter((_, i) => drawn(i, data.p)).length;
    if (!points) return refuse(id, "No frame was tracked.");
    const entry = { id, series: truth ? 2 : 1, points, ink: -1 };
    const box = place(id), height = (width) => Math.round(Math.min(0.85 * width, 420));
    const bounds = [[a].concat(truth ? [truth[0]] : []), [b].concat(truth ? [truth[1]] : [])].map((lists) => {
      let low = Infinity, high = -Infinity;
      for (const list of lists) for (const v of list) if (finite(v)) { low = Math.min(low, v); high = Math.max(high, v); }
      return [low, high];
    });
    // A window as asked for, or wider: one metre is as long on both axes.
    const show = (u, [x0, x1], [y0, y1]) => {
      const metres = Math.max((x1 - x0) / u.bbox.width, (y1 - y0) / u.bbox.height, 1e-6);
      const w = (metres * u.bbox.width) / 2, h = (metres * u.bbox.height) / 2;
      u.batch(() => {
        u.setScale("x", { min: (x0 + x1) / 2 - w, max: (x0 + x1) / 2 + w });
        u.setScale("y", { min: (y0 + y1) / 2 - h, max: (y0 + y1) / 2 + h });
      });
    };
    let wanted = null;
    const whole = (u) => {
      const margin = 0.06 * Math.max(bounds[0][1] - bounds[0][0], bounds[1][1] - bounds[1][0], 0.05);
      wanted = bounds.map(([low, high]) => [low - margin, high + margin]);
      show(u, wanted[0], wanted[1]);
    };
    const options = {
      mode: 2, width: Math.max(200, box.clientWidth), height: height(box.clientWidth),
      legend: { show: false },
      cursor: { drag: { x: true, y: true, setScale: false }, points: { show: false },
        bind: { dblclick: (u) => () => { whole(u); return null; } } },
      scales: { x: { time: false, auto: false, range: (u, lo, hi) => [lo, hi] }, y: { auto: false, range: (u, lo, hi) => [lo, hi] } },
      axes: [axis(names[0] + " (m)", { size: 34 }), axis(names[1] + " (m)", { size: 54 })],
      series: [{}, { facets: [{ scale: "x", auto: false }, { scale: "y", auto: false }], label: "camera",
        paths: (u) => { drawTrajectory(u, a, b, truth); return null; } }],
      hooks: merge(inkHooks(entry), {
        ready: [whole],
        setSelect: [(u) => {
          const s = u.select;
          if (s.width < 5 || s.height < 5) return;
          wanted = [[u.posToVal(s.left, "x"), u.posToVal(s.left + s.width, "x")],
            [u.posToVal(s.top + s.height, "y"), u.posToVal(s.top, "y")]];
          show(u, wanted[0], wanted[1]);
          u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        }],
      }),
    };
    const u = new uPlot(options, [null, [a, b]], box);
    watchSize(u, box, height, () => show(u, wanted[0], wanted[1]));
    charts.push(u);
    status.charts.push(entry);
  }

  // ---- Categories over time: a row a motion model, a row a reason for a lost frame, key frames.
  function states() {
    const rows = [];
    data.failures.forEach((name, k) => rows.push({ name, colour: "--lost", has: (i) => data.failure[i] === k }));
    data.models.forEach((name, k) => rows.push({ name, colour: "--accent", has: (i) => data.model[i] === k }));
    if (data.key.some((k) => k)) rows.push({ name: "key frame", colour: "--ink", has: (i) => data.key[i] === 1 });
    const width = Math.min(170, 24 + 7 * Math.max(4, ...rows.map((row) => row.name.length)));
    const short = (name) => (name.length > 20 ? name.slice(0, 19) + "…" : name);
    timeChart("chart-states", "", rows.map((row, k) => ({
      name: row.name, colour: row.colour, values: xs.map((_, i) => (row.has(i) ? k : null)),
      paths: () => null, points: { show: true, size: 5, width: 0, fill: () => css(row.colour) }, text: (i) => (row.has(i) ? "yes" : "no"),
    })), {
      height: 110 + 26 * rows.length, yScale: { range: () => [-0.6, rows.length - 0.4] },
      yAxis: { label: undefined, size: width, splits: () => rows.map((_, k) => k), values: () => rows.map((row) => short(row.name)) },
    });
  }

  function drawAll() {
    const [forward, up] = data.truth ? [1, 2] : [2, 1]; // without a truth the first camera is the world: y down
    const sign = data.truth ? 1 : -1, name = "xyz", top = data.truth ? "y" : "z";
    const upName = data.truth ? "z" : "−y";
    view("chart-top", ["x", top], [0, forward], [1, 1]);
    view("chart-front", [name[0], upName], [0, up], [1, sign]);
    view("chart-side", [top, upName], [forward, up], [1, sign]);
    if (data.error) {
      const mm = data.error.map((v) => (finite(v) ? 1000 * v : null));
      timeChart("chart-error", "error (mm)", [{ name: "error (mm)", values: mm, colour: "--accent", digits: 1 }],
        { hooks: { drawAxes: [drawLost] }, yScale: { range: (u, a, b) => [0, b > 0 ? b * 1.08 : 1] } });
    }
    stacked("chart-stages", "ms", data.stages.map((s, k) => ({ name: s.name, values: s.ms, colour: stagePalette[k % stagePalette.length] })), 1);
    stacked("chart-labels", "key points", ["static", "suspect", "unmatched", "dynamic"].map((l) => (
      { name: l, values: data.labels[l], colour: "--" + l })), 0);
    const step = uPlot.paths.stepped({ align: 1 });
    timeChart("chart-boxes", "boxes", [{ name: "all boxes", values: data.boxes, colour: "--accent", paths: step, digits: 0 },
      { name: "dynamic boxes", values: data.dynamic_boxes, colour: "--dynamic", paths: step, digits: 0 }],
    { yScale: { range: (u, a, b) => [0, Math.max(1, b) * 1.1] }, height: 200 });
    states();
  }

  document.querySelectorAll("[data-zoom]").forEach((button) => button.addEventListener("click", () => {
    const kind = button.dataset.zoom;
    if (kind === "all" && timeCharts.length) {
      const [min, max] = wholeRange();
      timeCharts[0].setScale("x", { min, max });
    } else if (kind === "in" || kind === "out") zoomTime(kind === "in" ? 0.5 : 2, 0);
    else if (kind === "left" || kind === "right") zoomTime(1, kind === "left" ? -0.4 : 0.4);
  }));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => charts.forEach((u) => u.redraw()));

  if (frames) drawAll();
  else document.querySelectorAll(".chart").forEach((c) => refuse(c.id, "The run had no frames."));
  const publish = () => { document.getElementById("status").textContent = JSON.stringify(status); };
  const span = (u) => u.scales.x.max - u.scales.x.min;
  setTimeout(() => {
    if (!check || !timeCharts.length) return publish();
    // Zoom by the page's own buttons: each chart's time axis must show half, then all again.
    const press = (kind) => document.querySelector(`[data-zoom="${kind}"]`).click();
    const whole = span(timeCharts[0]);
    press("in");
    setTimeout(() => {
      status.zoomed = timeCharts.map((u) => span(u) / whole);
      press("all");
      setTimeout(() => {
        status.restored = timeCharts.map((u) => span(u) / whole);
        publish();
      }, 50);
    }, 50);
  }, 50);
})();
