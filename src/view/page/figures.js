// What the print comes to: a list for one, a table for several.

function listOf(title, rows) {
  const list = element("dl");
  for (const [name, value] of rows) {
    if (value !== null) list.append(element("dt", {}, name), element("dd", {}, value));
  }
  return [element("h2", {}, title), list];
}

/** The whole print and the layer. */
function drawFigures(root, print, layer) {
  const { total, filament_g: grams, time_bound: times } = print;
  root.replaceChildren(
    ...listOf("Print", [
      ["Time", duration(total.total_s)],
      ["Filament", `${length(total.filament_mm)}, ${fixed(grams, 1)} g`],
      ["Printed", length(total.print_mm)],
      ["Travel", `${length(total.travel_mm)} (${percent(total.travel_mm / (total.total_mm || 1))})`],
      ["Travels", String(total.travels)],
      ["Retractions", String(total.retractions)],
      ["Links", length(total.link_mm)],
      ["Bound", "bound_mm" in total ? length(total.bound_mm) : null],
      ["Gap", "gap" in total ? percent(total.gap) : null],
      ["Time of links", times ? duration(times.link_s) : null],
      ["Bound of time", times ? duration(times.bound_s) : null],
      ["Gap in time", times?.gap_s != null ? percent(times.gap_s) : null],
      ["Layers", String(print.layers)],
      ["Moves", String(print.strokes)],
    ]),
    ...listOf("Layer", [
      ["Height", `${fixed(print.z[layer], 2)} mm`],
      ["Time", duration(print.time[layer])],
      ["Printed", length(print.print[layer])],
      ["Travel", length(print.travel[layer])],
      ["Travels", String(print.travels[layer])],
      ["Retractions", String(print.retractions[layer])],
      ["Bound", print.bound[layer] >= 0 ? length(print.bound[layer]) : null],
      ["Gap", print.bound[layer] >= 0 ? percent(gapOf(print.link[layer], print.bound[layer])) : null],
    ]),
  );
}

/** Prints below each other: this layer, then all of it. The best of each column is bold. */
function drawTable(root, prints, layer) {
  const bounded = prints.some((print) => "bound_mm" in print.total), timed = prints.some((print) => print.time_bound);
  const columns = [
    ["Links", (p) => p.link[layer], length],
    ...(bounded ? [["Gap", (p) => gapOf(p.link[layer], p.bound[layer]), percent]] : []),
    ["Travel", (p) => p.travel[layer], length],
    ["Time", (p) => p.time[layer], duration],
    ["Links", (p) => p.total.link_mm, length],
    ...(bounded ? [["Gap", (p) => p.total.gap ?? null, percent]] : []),
    ...(timed ? [["Gap in time", (p) => p.time_bound?.gap_s ?? null, percent]] : []),
    ["Travel", (p) => p.total.travel_mm, length],
    ["Retractions", (p) => p.total.retractions, String],
    ["Time", (p) => p.total.total_s, duration],
  ];
  const ofLayer = bounded ? 4 : 3;
  const values = columns.map(([, value]) => prints.map(value));
  const least = values.map((column) => Math.min(...column.filter((v) => v !== null && v !== undefined)));
  const heads = (row) => row.map(([name]) => element("th", { scope: "col" }, name));
  root.replaceChildren(element("table", {},
    element("caption", {}, "Links are the straight lines between paths, which ordering shortens; the gap is how far they are above a length that no order can go below, the gap in time the same of their times, where these are what ordering makes least."),
    element("thead", {},
      element("tr", {}, element("th", { rowspan: 2 }, "Strategy"), element("th", { colspan: ofLayer }, `Layer ${layer + 1}`),
        element("th", { colspan: columns.length - ofLayer }, "Whole print")),
      element("tr", {}, ...heads(columns))),
    element("tbody", {}, ...prints.map((print, i) => element("tr", {},
      element("th", { scope: "row", style: `color: ${PRINT_COLORS[i % PRINT_COLORS.length]}` }, print.name),
      ...columns.map(([, , text], c) => {
        const value = values[c][i], known = value !== null && value !== undefined && !Number.isNaN(value);
        return element("td", { class: known && value === least[c] ? "best" : false }, known ? text(value) : "–");
      })))),
  ));
}
