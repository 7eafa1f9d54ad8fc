"use strict";
(() => {
  const table = document.getElementById("table"), body = table.tBodies[0], rows = [...body.rows];
  const filters = document.getElementById("filters"), count = document.getElementById("count");
  const more = document.getElementById("more"), LINK = "#rows:";
  const { command, scenes, seeds } = JSON.parse(document.getElementById("row-data").textContent);
  const heads = [...table.tHead.rows[0].cells];
  const COLUMNS = { scene: 0, engine: 2, profile: 3, policy: 4 };
  const AT_FIRST = rows.filter(row => !row.hidden).length;
  const textIn = cell => [...cell.childNodes].filter(node => node.className !== "flag").map(node => node.textContent).join("").replace(/\s+/g, " ").trim(); // without flags of public threads
  const valueOf = (row, name) => {
    if (name === "outcome") return row.className;
    return name === "family" ? scenes[valueOf(row, "scene")].scenario : textIn(row.cells[COLUMNS[name]]);
  };
  const words = new Map();
  const wordsOf = row => {
    if (!words.has(row)) words.set(row, row.textContent.toLowerCase());
    return words.get(row);
  };
  const selection = [...rows]; // the rows that fit the filters, also those beyond the limit
  let limit = AT_FIRST;

  // Ratios of frame times to those of a set-up that the reader chooses, scene by scene.
  const setUpOf = row => ["engine", "profile", "policy"].map(name => valueOf(row, name)).join(" ");
  const TIMES = heads.flatMap((head, column) => /^p\d+/.test(head.textContent.trim()) ? [column] : []);
  const numberOf = cell => Number(cell.dataset.sort ?? cell.firstChild.textContent);
  const compare = base => {
    table.querySelectorAll("small.ratio").forEach(ratio => ratio.remove());
    if (!base) return;
    const bases = new Map(rows.filter(row => setUpOf(row) === base).map(row => [valueOf(row, "scene"), row]));
    for (const row of selection.filter(row => !row.hidden))
      for (const column of TIMES) {
        const other = bases.get(valueOf(row, "scene"));
        const ratio = other && numberOf(row.cells[column]) / numberOf(other.cells[column]);
        if (!Number.isFinite(ratio)) continue;
        const shown = document.createElement("small");
        shown.className = "ratio";
        shown.textContent = ` ×${ratio.toPrecision(2)}`;
        row.cells[column].append(shown);
      }
  };

  const filter = () => {
    const { text, base, ...wanted } = Object.fromEntries(new FormData(filters));
    const sought = text.toLowerCase().split(/\s+/).filter(Boolean), chosen = Object.entries(wanted).filter(([, value]) => value);
    let found = 0;
    selection.length = 0;
    for (const row of body.rows) {
      const fits = chosen.every(([name, value]) => valueOf(row, name) === value) && sought.every(word => wordsOf(row).includes(word));
      found += fits;
      row.hidden = !fits || found > limit;
      if (fits) selection.push(row);
    }
    compare(base);
    count.textContent = `${Math.min(found, limit)} of ${rows.length}`;
    more.hidden = found <= limit;
  };

  const sort = (column, down) => {
    const head = heads[column];
    heads.forEach(other => other.hasAttribute("aria-sort") && other.setAttribute("aria-sort", "none"));
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const value = row => {
      const cell = row.cells[column];
      return heads[column].classList.contains("figure") ? numberOf(cell) : textIn(cell);
    };
    const order = (a, b) => {
      if (typeof a === "string") return a.localeCompare(b, "en", { numeric: true }) * (down ? -1 : 1);
      if (isNaN(a) || isNaN(b)) return isNaN(a) - isNaN(b); // missing values come last in both directions
      return (a - b) * (down ? -1 : 1);
    };
    const keys = new Map(rows.map(row => [row, value(row)]));
    body.append(...[...body.rows].sort((a, b) => order(keys.get(a), keys.get(b))));
    filter();
  };

  // The address keeps the filters and the order, so that a view of the table can be linked.
  const keep = () => {
    const state = new URLSearchParams([...new FormData(filters)].filter(([, value]) => value));
    const sorted = heads.findIndex(head => /ascending|descending/.test(head.getAttribute("aria-sort")));
    if (sorted >= 0) state.set("sort", `${heads[sorted].getAttribute("aria-sort") === "descending" ? "-" : ""}${sorted}`);
    history.replaceState(null, "", state.size ? LINK + state : "#matrix");
  };
  const restore = () => {
    if (!location.hash.startsWith(LINK)) return;
    const state = new URLSearchParams(location.hash.slice(LINK.length));
    for (const field of filters.elements) if (field.name) field.value = state.get(field.name) ?? "";
    const sorted = /^(-?)(\d+)$/.exec(state.get("sort") ?? "");
    if (sorted && heads[sorted[2]]?.querySelector("button")) sort(+sorted[2], sorted[1] === "-");
    filter();
    land(document.getElementById("matrix"));
  };

  filters.addEventListener("input", () => { filter(); keep(); });
  filters.addEventListener("reset", () => setTimeout(() => { limit = AT_FIRST; filter(); keep(); }));
  filters.addEventListener("submit", event => event.preventDefault());
  more.addEventListener("click", () => { limit = Infinity; filter(); });
  heads.forEach((head, column) => head.querySelector("button")?.addEventListener("click", () => {
    sort(column, head.getAttribute("aria-sort") === "ascending");
    keep();
  }));
  addEventListener("hashchange", restore);

  // The selection as text for other programs: all rows that fit, without the last column.
  const FORMATS = {
    CSV: { line: cells => cells.map(cell => /[",\n]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell).join(",") },
    Markdown: { line: cells => `| ${cells.map(cell => cell.replaceAll("|", "\\|")).join(" | ")} |`, after: n => `|${" --- |".repeat(n)}` },
    LaTeX: {
      before: n => `\\begin{tabular}{${"l".repeat(n)}}`, after: () => "\\hline", end: "\\end{tabular}",
      line: cells => `${cells.map(cell => cell.replace(/[&%$#_{}]/g, "\\$&").replaceAll("≥", "$\\geq$").replaceAll("µ", "$\\mu$").replaceAll("±", "$\\pm$").replaceAll("×", "$\\times$").replaceAll("✓", "$\\surd$").replaceAll("✗", "$\\times$").replaceAll("†", "$\\dagger$").replaceAll("~", "$\\sim$")).join(" & ")} \\\\`,
    },
  };
  const cellsOf = row => [...row.cells].slice(0, -1).map(textIn);
  const textOf = format => {
    const { before, line, after, end } = FORMATS[format], head = cellsOf(table.tHead.rows[0]);
    return [before?.(head.length), line(head), after?.(head.length), ...selection.map(row => line(cellsOf(row))), end].filter(Boolean).join("\n") + "\n";
  };
  document.getElementById("link").addEventListener("click", async () => {
    const note = document.getElementById("copied");
    keep();
    try {
      await navigator.clipboard.writeText(location.href);
      note.textContent = "link copied";
    } catch { // where a page may not use the clipboard
      note.textContent = location.href;
    }
    if (location.protocol === "file:") note.textContent += "; it begins with file:///, so that your colleague also needs the page as one file: uv run -m bench report DIR --single";
  });
  document.getElementById("copy").addEventListener("click", async event => {
    const format = event.target.closest("button")?.textContent;
    if (!(format in FORMATS)) return;
    const note = document.getElementById("copied"), text = textOf(format);
    try {
      await navigator.clipboard.writeText(text);
      note.textContent = `${selection.length} rows copied as ${format}`;
    } catch { // where a page may not use the clipboard
      const link = document.createElement("a");
      Object.assign(link, { href: URL.createObjectURL(new Blob([text])), download: `comparison.${{ CSV: "csv", Markdown: "md", LaTeX: "tex" }[format]}` });
      link.click();
      note.textContent = `${selection.length} rows saved as ${link.download}`;
    }
  });

  // The command that makes the numbers of a row again, written when it is opened.
  const quoted = word => /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", `'"'"'`)}'`;
  table.addEventListener("toggle", event => {
    const how = event.target, row = how.closest("tr");
    if (!how.open) return;
    if (how.querySelector("code")) { how.scrollIntoView({ block: "nearest", inline: "end" }); return; }
    const { scenario, theory } = scenes[valueOf(row, "scene")];
    const options = { engine: valueOf(row, "engine"), profile: valueOf(row, "profile"), scenario, policy: valueOf(row, "policy"), seeds: row.dataset.seeds ?? seeds };
    const all = [...command, ...Object.entries(options).flatMap(([name, value]) => [`--${name}`, `${value}`])];
    const line = document.createElement("p"), code = document.createElement("code"), copy = document.createElement("button"), why = document.createElement("p");
    code.textContent = all.map(quoted).join(" ");
    Object.assign(copy, { type: "button", className: "copy", textContent: "copy" });
    line.className = "command";
    line.append(code, " ", copy);
    why.textContent = `Theory: ${theory}`;
    how.querySelector("summary").after(line, why);
    how.scrollIntoView({ block: "nearest", inline: "end" });
  }, true);
  restore();
})();
