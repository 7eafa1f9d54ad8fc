"use strict";
// Scroll to a section, and again whenever the page changes its height, until the reader acts: fonts, pictures and tables
// that turn out to fit their width come after the first layout.
const land = section => {
  const scroll = () => section.scrollIntoView({ behavior: "instant" });
  const growth = new ResizeObserver(scroll), acts = ["wheel", "pointerdown", "touchstart", "keydown"];
  const leave = () => {
    growth.disconnect();
    acts.forEach(act => removeEventListener(act, leave, true));
  };
  acts.forEach(act => addEventListener(act, leave, { capture: true, passive: true }));
  growth.observe(document.querySelector("main"));
};
// A reloaded page with a view in its address shows this view, not the place that the browser remembers.
if (/^#(rows|families):/.test(location.hash)) history.scrollRestoration = "manual";
