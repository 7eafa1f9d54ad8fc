"use strict";
(() => {
  // Frame times of one scene on one engine: the curves of all policies in one plot.
  const source = document.getElementById("trace-data");
  if (!source) return;
  const traces = JSON.parse(source.textContent), chosen = document.getElementById("chosen");
  const plot = document.getElementById("plot"), legend = document.getElementById("legend");
  const engineOf = trace => `${trace.engine} ${trace.profile}`;
  const fill = (select, values) => {
    const before = select.value;
    select.replaceChildren(...[...new Set(values)].map(value => new Option(value)));
    if (values.includes(before)) select.value = before;
  };
  const milliseconds = quantised => 10 ** (quantised / 100) / 1e3;
  const W = 960, H = 340, LEFT = 72, RIGHT = 14, TOP = 12, BOTTOM = 46;
  const element = (name, attributes, text) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    return made;
  };
  const draw = () => {
    const shown = traces.filter(trace => trace.scene === chosen.scene.value && engineOf(trace) === chosen.engine.value);
    const end = Math.max(...shown.map(trace => trace.to));
    const all = shown.flatMap(trace => [...trace.median, ...trace.worst]);
    const low = Math.floor(Math.min(...all) / 100) * 100, high = Math.max(Math.max(...all), 430);
    const x = seconds => LEFT + seconds / end * (W - LEFT - RIGHT);
    const y = quantised => H - BOTTOM - (quantised - low) / (high - low) * (H - TOP - BOTTOM);
    const svg = element("svg", { viewBox: `0 0 ${W} ${H}`, role: "img", "font-size": 12, fill: "currentColor",
      "aria-label": `Frame times of ${chosen.scene.value} on ${chosen.engine.value}` });
    for (let decade = low; decade <= high; decade += 100) {
      svg.append(element("line", { x1: LEFT, x2: W - RIGHT, y1: y(decade), y2: y(decade), stroke: "var(--faint)" }));
      svg.append(element("text", { x: LEFT - 8, y: y(decade) + 4, "text-anchor": "end" }, `${+milliseconds(decade).toPrecision(2)} ms`));
    }
    const step = [1, 2, 5, 10, 20, 50, 100, 200, 500].find(one => end / one <= 12) ?? 1000;
    for (let second = 0; second <= end; second += step)
      svg.append(element("text", { x: x(second), y: H - BOTTOM + 30, "text-anchor": "middle" }, `${second} s`));
    for (const hertz of [60, 90]) {
      const at = y(100 * Math.log10(1e6 / hertz));
      svg.append(element("line", { x1: LEFT, x2: W - RIGHT, y1: at, y2: at, stroke: "currentColor", "stroke-dasharray": "6 4", opacity: .6 }));
      svg.append(element("text", { x: W - RIGHT, y: hertz === 60 ? at - 4 : at + 13, "text-anchor": "end", "font-size": 11 }, `${hertz} Hz`));
    }
    shown.forEach((trace, number) => {
      const ink = `var(--policy-${trace.policy})`, n = trace.median.length;
      const at = index => x(trace.from + (trace.to - trace.from) * (index + .5) / n).toFixed(1);
      const line = values => values.map((value, index) => `${at(index)} ${y(value).toFixed(1)}`).join("L");
      const area = `M${line(trace.worst)}L${trace.median.map((value, index) => `${at(index)} ${y(value).toFixed(1)}`).reverse().join("L")}Z`;
      svg.append(element("path", { d: area, fill: ink, opacity: .16 }));
      svg.append(element("path", { d: `M${line(trace.median)}`, fill: "none", stroke: ink, "stroke-width": 1.8 }));
      const row = H - BOTTOM + 4 + 5 * number;
      for (const second of trace.wakes)
        svg.append(element("rect", { x: x(second) - 1, y: row, width: 2, height: 5, fill: ink }));
      if (trace.falls !== null)
        svg.append(element("text", { x: x(trace.falls), y: TOP + 12 + 14 * number, "text-anchor": "middle", fill: ink, "font-weight": 700 }, "✕"));
    });
    plot.replaceChildren(svg);
    legend.replaceChildren(...shown.map(trace => {
      const entry = document.createElement("span"), swatch = document.createElement("i");
      swatch.className = "swatch";
      swatch.style.setProperty("--ink", `var(--policy-${trace.policy})`);
      const events = [trace.wakes.length && `${trace.wakes.length} wakes`, trace.falls !== null && `fell at ${trace.falls.toFixed(1)} s`];
      entry.append(swatch, `${trace.policy}${events.filter(Boolean).map(event => `, ${event}`).join("")}`);
      return entry;
    }));
  };
  const choose = () => {
    fill(chosen.engine, traces.filter(trace => trace.scene === chosen.scene.value).map(engineOf));
    draw();
  };
  fill(chosen.scene, traces.map(trace => trace.scene));
  chosen.addEventListener("input", choose);
  choose();
})();
