"use strict";
for (const map of document.querySelectorAll(".heat table")) (() => {
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
    const target = {
      ArrowRight: row.cells[column + 1], ArrowLeft: column > 2 ? row.cells[column - 1] : undefined,
      ArrowDown: body[at + 1]?.cells[column], ArrowUp: body[at - 1]?.cells[column],
      Home: row.cells[2], End: row.cells[row.cells.length - 1],
    }[event.key];
    if (event.key === "Enter") location.hash = addressOf(cell);
    else if (target) go(target);
    else return;
    event.preventDefault();
  });
})();
