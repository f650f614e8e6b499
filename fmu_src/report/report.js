/* The report: a tab per joint, and the charts of its figures. */

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

const tabs = [...document.querySelectorAll("[role=tab]")];

function select(tab) {
  for (const each of tabs) {
    each.setAttribute("aria-selected", each === tab);
    each.tabIndex = each === tab ? 0 : -1;
    document.getElementById(each.getAttribute("aria-controls")).hidden = each !== tab;
  }
  drawAll();
}

for (const [i, tab] of tabs.entries()) {
  tab.addEventListener("click", () => {
    history.replaceState(null, "", `#${tab.dataset.name}`);
    select(tab);
  });
  tab.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const next = tabs[(i + step + tabs.length) % tabs.length];
    next.focus();
    next.click();
  });
}
const named = () => tabs.find((tab) => tab.dataset.name === location.hash.slice(1)) || tabs[0];
addEventListener("hashchange", () => select(named()));
addEventListener("resize", drawAll);
select(named());
