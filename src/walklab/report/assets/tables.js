// Tables that sort by a column when its heading is pressed, and the filter of the table of verdicts.
function sortKey(cell) {
  const text = cell.hasAttribute("data-sort") ? cell.getAttribute("data-sort") : cell.textContent.trim();
  const number = Number(text);
  return text === "" || text === "nan" ? null : Number.isNaN(number) ? text.toLowerCase() : number;
}

// Nothing comes last whichever way; numbers before words.
function compareKeys(a, b) {
  if (typeof a === typeof b) { return typeof a === "number" ? a - b : a.localeCompare(b, "en", { numeric: true }); }
  return typeof a === "number" ? -1 : 1;
}

function sortTable(heading) {
  const table = heading.closest("table");
  const column = Array.from(heading.parentNode.children).indexOf(heading);
  const up = heading.getAttribute("aria-sort") !== "ascending";
  for (const other of heading.parentNode.children) { other.removeAttribute("aria-sort"); }
  heading.setAttribute("aria-sort", up ? "ascending" : "descending");
  const body = table.tBodies[0];
  const rows = Array.from(body.rows, (row) => ({ row, key: sortKey(row.cells[column]) }));
  rows.sort((a, b) => {
    if (a.key === null || b.key === null) { return (a.key === null) - (b.key === null); }
    return up ? compareKeys(a.key, b.key) : compareKeys(b.key, a.key);
  });
  for (const { row } of rows) { body.appendChild(row); }
}

function startTables() {
  for (const button of document.querySelectorAll("th .sort")) {
    button.addEventListener("click", () => sortTable(button.closest("th")));
  }
}

function startVerdictFilter() {
  const form = document.getElementById("verdict-filter");
  if (!form) { return; }
  const rows = Array.from(document.querySelectorAll("#verdict-table tbody tr"));
  function apply() {
    const wanted = new Set(Array.from(form.querySelectorAll("input[name=verdict]:checked"), (box) => box.value));
    const words = form.elements.words.value.toLowerCase().split(/\s+/).filter(Boolean);
    let count = 0;
    for (const row of rows) {
      const text = row.textContent.toLowerCase();
      row.hidden = !wanted.has(row.dataset.verdict) || !words.every((word) => text.includes(word));
      count += row.hidden ? 0 : 1;
    }
    form.querySelector("output").textContent = count + " of " + rows.length + " claims";
  }
  form.addEventListener("input", apply);
  form.addEventListener("submit", (event) => event.preventDefault());
  apply();
}

startTables();
startVerdictFilter();
