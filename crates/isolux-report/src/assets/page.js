"use strict";
// Without this script the page reads the same: it only adds sorting and copying to tables.
for (const figure of document.querySelectorAll("figure.table")) {
  const table = figure.querySelector("table");
  const body = table.tBodies[0];
  const headings = [...table.tHead.rows[0].cells];
  const numberOf = (cell) => cell.dataset.value === undefined ? NaN : Number(cell.dataset.value);
  const compare = (a, b) => {
    const [x, y] = [numberOf(a), numberOf(b)];
    if (isNaN(x) !== isNaN(y)) return isNaN(x) ? 1 : -1;
    return isNaN(x) ? a.textContent.localeCompare(b.textContent, undefined, { numeric: true }) : x - y;
  };
  headings.forEach((heading, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...heading.childNodes);
    heading.append(button);
    button.addEventListener("click", () => {
      const sign = heading.getAttribute("aria-sort") === "ascending" ? -1 : 1;
      headings.forEach((other) => other.removeAttribute("aria-sort"));
      heading.setAttribute("aria-sort", sign === 1 ? "ascending" : "descending");
      const rows = [...body.rows];
      rows.sort((a, b) => {
        const [x, y] = [a.cells[column], b.cells[column]];
        // Missing values stay last, whichever way the others run.
        const order = compare(x, y);
        return isNaN(numberOf(x)) === isNaN(numberOf(y)) ? sign * order : order;
      });
      body.append(...rows);
    });
  });
  const text = (cell) => {
    const copy = cell.cloneNode(true);
    copy.querySelectorAll(".star").forEach((star) => star.remove());
    return copy.textContent;
  };
  const button = document.createElement("button");
  button.type = "button";
  button.className = "file";
  button.textContent = "Copy";
  button.title = "Copy the table, for a spreadsheet";
  button.addEventListener("click", () => {
    const area = document.createElement("textarea");
    area.value = [...table.rows].map((row) => [...row.cells].map(text).join("\t")).join("\n");
    document.body.append(area);
    area.select();
    button.textContent = document.execCommand("copy") ? "Copied" : "Not copied";
    area.remove();
  });
  figure.querySelector("figcaption").append(" ", button);
}
