"use strict";
const heatMaps = document.querySelectorAll(".heat table");
for (const map of heatMaps) (() => {
  const detail = map.parentElement.previousElementSibling;
  const scenes = [...map.tHead.rows[0].cells];
  let current = map.tBodies[0].rows[0]?.cells[2];
  if (!current) return;
  current.tabIndex = 0;

  const addressOf = cell => {
    const { engine, profile, policy } = cell.parentElement.dataset;
    return `#rows:${new URLSearchParams({ [map.dataset.by]: scenes[cell.cellIndex].title, engine, profile, policy })}`;
  };
  const describe = cell => {
    const { engine, profile, policy } = cell.parentElement.dataset, head = scenes[cell.cellIndex];
    const set_up = document.createElement("b"), link = document.createElement("a");
    set_up.textContent = `${engine} ${profile} ${policy}`;
    Object.assign(link, { href: addressOf(cell), textContent: "its numbers" });
    const note = head.querySelector("small").textContent;
    detail.replaceChildren(set_up, ` on ${head.title} (${note}): ${cell.querySelector("b").textContent}. `, link);
  };
  const cellOf = event => {
    const cell = event.target.closest("tbody td");
    return cell && cell.cellIndex > 1 ? cell : null;
  };
  const go = cell => {
    current.removeAttribute("tabindex");
    current = cell;
    current.tabIndex = 0;
    current.focus();
  };

  const isHeld = () => document.activeElement === current; // a clicked cell keeps its line on the pointer's way to the link
  map.addEventListener("mouseover", event => { const cell = cellOf(event); if (cell && !isHeld()) describe(cell); });
  map.addEventListener("focusin", event => { const cell = cellOf(event); if (cell) describe(cell); });
  map.addEventListener("click", event => { const cell = cellOf(event); if (cell) go(cell); });
  map.addEventListener("keydown", event => {
    const cell = cellOf(event);
    if (!cell) return;
    const row = cell.parentElement, body = row.parentElement.rows, at = row.sectionRowIndex, column = cell.cellIndex;
    const shown = [...row.cells].slice(2).filter(other => !other.hidden), place = shown.indexOf(cell);
    const target = {
      ArrowRight: shown[place + 1], ArrowLeft: shown[place - 1],
      ArrowDown: body[at + 1]?.cells[column], ArrowUp: body[at - 1]?.cells[column],
      Home: shown[0], End: shown.at(-1),
    }[event.key];
    if (event.key === "Enter") location.hash = addressOf(cell);
    else if (target) go(target);
    else return;
    event.preventDefault();
  });

  // One family alone: its columns, and how many of its pairs and other scenes each set-up has right.
  const rights = [...map.tBodies[0].rows].map(row => row.cells[1].textContent);
  document.getElementById("families").addEventListener("input", event => {
    const family = event.target.value;
    for (const row of map.rows)
      for (const [column, cell] of [...row.cells].entries())
        if (column > 1) cell.hidden = family !== "" && scenes[column].dataset.family !== family;
    [...map.tBodies[0].rows].forEach((row, number) => {
      row.cells[1].textContent = family === "" ? rights[number] : JSON.parse(row.cells[1].dataset.in)[family] ?? "-";
    });
    current.removeAttribute("tabindex");
    current = [...map.tBodies[0].rows[0].cells].slice(2).find(cell => !cell.hidden);
    current.tabIndex = 0;
  });
})();
const families = document.getElementById("families"), FAMILIES = "#families:";
families.addEventListener("input", event => {
  const form = event.currentTarget, family = event.target.value, note = form.querySelector("output"), link = document.createElement("a");
  document.querySelectorAll(".by-family").forEach(map => { map.hidden = family !== ""; });
  document.querySelectorAll(".by-scene").forEach(details => { details.open ||= family !== ""; });
  Object.assign(link, { href: `#rows:${new URLSearchParams({ family })}`, textContent: "its numbers" });
  if (family === "") note.replaceChildren();
  else note.replaceChildren("The column “right” counts this family alone; ", link, ".");
  history.replaceState(null, "", family === "" ? "#map" : FAMILIES + new URLSearchParams({ family })); // so that it can be linked
});
const restoreFamily = () => {
  if (!location.hash.startsWith(FAMILIES)) return;
  families.elements.family.value = new URLSearchParams(location.hash.slice(FAMILIES.length)).get("family") ?? "";
  families.elements.family.dispatchEvent(new Event("input", { bubbles: true }));
  land(document.getElementById("map"));
};
addEventListener("hashchange", restoreFamily);
restoreFamily();
