"use strict";
(() => {
  const table = document.getElementById("table"), body = table.tBodies[0], rows = [...body.rows];
  const filters = document.getElementById("filters"), count = document.getElementById("count");
  const more = document.getElementById("more"), LINK = "#rows:";
  const { command, scenes, seeds } = JSON.parse(document.getElementById("row-data").textContent);
  const COLUMNS = { scene: 0, engine: 2, profile: 3, policy: 4 };
  const AT_FIRST = rows.filter(row => !row.hidden).length;
  const valueOf = (row, name) => name === "outcome" ? row.className : row.cells[COLUMNS[name]].textContent;
  const words = new Map();
  const wordsOf = row => {
    if (!words.has(row)) words.set(row, row.textContent.toLowerCase());
    return words.get(row);
  };
  let limit = AT_FIRST;

  const filter = () => {
    const { text, ...wanted } = Object.fromEntries(new FormData(filters));
    const sought = text.toLowerCase().split(/\s+/).filter(Boolean), chosen = Object.entries(wanted).filter(([, value]) => value);
    let found = 0;
    for (const row of body.rows) {
      const fits = chosen.every(([name, value]) => valueOf(row, name) === value) && sought.every(word => wordsOf(row).includes(word));
      found += fits;
      row.hidden = !fits || found > limit;
    }
    count.textContent = `${Math.min(found, limit)} of ${rows.length}`;
    more.hidden = found <= limit;
  };

  const heads = [...table.tHead.rows[0].cells];
  const sort = (column, down) => {
    const head = heads[column];
    heads.forEach(other => other.hasAttribute("aria-sort") && other.setAttribute("aria-sort", "none"));
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const value = row => {
      const cell = row.cells[column];
      return heads[column].classList.contains("figure") ? Number(cell.dataset.sort ?? cell.textContent) : cell.textContent;
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
    document.getElementById("matrix").scrollIntoView();
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

  // The command that makes the numbers of a row again, written when it is opened.
  const quoted = word => /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", `'"'"'`)}'`;
  table.addEventListener("toggle", event => {
    const how = event.target, row = how.closest("tr");
    if (!how.open || how.querySelector("code")) return;
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
  }, true);
  restore();
})();
