/* The charts of a page's figures. */

const charts = [];
for (const place of document.querySelectorAll(".figure")) {
  const panels = JSON.parse(place.querySelector("script").textContent), made = element("div", { class: "charts" });
  place.append(made);
  for (const panel of panels) charts.push([new Chart(made, panel.title), panel]);
}

/** A label with its unit in brackets as it is read. */
const labelled = (text) => text.replace(/ \[([^\]]*)\]/, (_, unit) => withUnit("", unit));

/** Charts of the tab that is shown; a hidden one has no width. */
function drawAll() {
  for (const [chart, panel] of charts) if (!chart.figure.closest("[hidden]")) chart.draw(panel.series, { label: labelled(panel.x), log: panel.log }, { label: labelled(panel.y) });
}
addEventListener("resize", drawAll);

