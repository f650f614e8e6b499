/* The charts of a page's figures. */

const charts = [];
for (const place of document.querySelectorAll(".figure")) {
  const panels = JSON.parse(place.querySelector("script").textContent), made = element("div", { class: "charts" });
  place.append(made);
  for (const panel of panels) charts.push([new Chart(made, panel.title), panel]);
}

/** Charts of the tab that is shown; a hidden one has no width. */
function drawAll() {
  for (const [chart, panel] of charts) if (!chart.figure.closest("[hidden]")) chart.draw(panel.series, { label: panel.x }, { label: panel.y });
}
addEventListener("resize", drawAll);

