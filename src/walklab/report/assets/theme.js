"use strict";
// Light, dark or as the system has it; remembered where the browser lets a page remember.
const THEMES = ["system", "light", "dark"];

function rememberedTheme() {
  try { return localStorage.getItem("walklab-theme"); } catch (error) { return null; }
}

function applyTheme(theme) {
  const root = document.documentElement;
  if (theme === "system") { root.removeAttribute("data-theme"); } else { root.setAttribute("data-theme", theme); }
  document.querySelector("#theme span").textContent = theme;
  try { localStorage.setItem("walklab-theme", theme); } catch (error) { /* a file opened from disk may not */ }
}

function startTheme() {
  let theme = THEMES.includes(rememberedTheme()) ? rememberedTheme() : "system";
  applyTheme(theme);
  document.getElementById("theme").addEventListener("click", () => {
    theme = THEMES[(THEMES.indexOf(theme) + 1) % THEMES.length];
    applyTheme(theme);
  });
}

// On a narrow screen the contents start folded; on paper everything is unfolded.
function startFolding() {
  if (window.matchMedia("(max-width: 68rem)").matches) { document.getElementById("contents-list").open = false; }
  window.addEventListener("beforeprint", () => {
    for (const fold of document.querySelectorAll("main details:not(.screen)")) { fold.open = true; }
  });
}

startTheme();
startFolding();
