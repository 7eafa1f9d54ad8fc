"use strict";
(() => {
  const root = document.documentElement;
  document.getElementById("theme").addEventListener("click", () => {
    const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    root.dataset.theme = dark ? "light" : "dark";
  });

  // A table that fits its width does not scroll in a box; its head then stays below the navigation.
  const fits = new ResizeObserver(entries => entries.forEach(({ target }) => {
    const box = target.closest(".wide");
    box.classList.toggle("whole", box.scrollWidth <= box.clientWidth);
  }));
  document.querySelectorAll(".wide, .wide > table").forEach(part => fits.observe(part));

  document.querySelectorAll("button.rest").forEach(button => button.addEventListener("click", () => {
    button.closest("section").querySelectorAll("tr[hidden]").forEach(row => { row.hidden = false; });
    button.parentElement.remove();
  }));

  // A button beside each command copies it; where the page may not use the clipboard, the text is selected.
  document.addEventListener("click", async event => {
    const button = event.target.closest("button.copy");
    if (!button) return;
    const code = button.parentElement.querySelector("code");
    try {
      await navigator.clipboard.writeText(code.textContent);
      button.textContent = "copied";
    } catch {
      getSelection().selectAllChildren(code);
      button.textContent = "selected";
    }
  });
})();
