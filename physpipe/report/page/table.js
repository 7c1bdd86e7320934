// Tables that sort: a press on a heading orders the rows by it, the next one turns the order round.

/** What a cell is sorted by: its number, else its text; null for an empty one. */
function keyOf(cell) {
  const given = cell.querySelector("data")?.value ?? cell.textContent.trim();
  const words = { True: 1, False: 0 };
  if (given in words) return words[given];
  if (given === "" || given === "–") return null;
  const number = Number(given);
  if (!Number.isNaN(number)) return number;
  const start = /^\d+ to \d+$/.exec(given);
  return start ? parseInt(given, 10) : given;
}

function compared(one, other) {
  if (typeof one === "number" && typeof other === "number") return one - other;
  return String(one).localeCompare(String(other), "en", { numeric: true });
}

/** Orders each group of the table's rows by column `index`; rows without a value stay last either way. */
function sortBy(table, index, descending) {
  for (const body of table.tBodies) {
    const rows = all("tr:not(.group)", body).map((row) => ({ row, key: keyOf(row.cells[index]) }));
    const known = rows.filter(({ key }) => key !== null).sort((a, b) => (descending ? -1 : 1) * compared(a.key, b.key));
    body.append(...[...known, ...rows.filter(({ key }) => key === null)].map(({ row }) => row));
  }
}

function sortable(table) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, index) => {
    const button = made(`<button type="button" title="Sort"></button>`);
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const descending = head.ariaSort === "ascending";
      heads.forEach((each) => each.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", descending ? "descending" : "ascending");
      sortBy(table, index, descending);
    });
  });
}
