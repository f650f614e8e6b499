/* The load ramp and its curves, published and measured points beside. */

const [STEPS, COARSE] = [120, 40];

/** Displayed numbers and label of a variable. */
const shown = (v, values) => values.map((x) => x * v.factor);
const label = (v) => withUnit(v.name, v.shown);

/** The load ramp from rest: { name: values } of all outputs and the driven input; what is refused ends it. */
function ramp(joint, values, end, steps, also = () => {}) {
  const driven = joint.about.ramp.input, names = joint.about.variables.filter((v) => v.causality === "output").map((v) => v.name);
  const found = Object.fromEntries([driven, ...names].map((name) => [name, []]));
  if (!joint.begin(new Map(values).set(driven, 0))) return found;
  for (let i = 0; i <= steps; i++) {
    const x = (end * i) / steps;
    if (i && !joint.step({ [driven]: x })) break;
    found[driven].push(x);
    for (const name of names) found[name].push(joint.get(name));
    also(x);
  }
  return found;
}

class Curves {
  constructor(place, joint) {
    this.joint = joint;
    this.panels = joint.about.panels.map((panel) => {
      const over = joint.variables.get(panel.over), quantities = panel.quantities.map((name) => joint.variables.get(name));
      return { over, quantities, chart: new Chart(place, `${panel.quantities.join(", ")} over ${panel.over}`, quantities.map((v) => v.doc).join("; ")) };
    });
  }

  /** A panel; found: the ramp. */
  draw({ over, quantities, chart }, lab, found) {
    const { now } = lab;
    const series = quantities.map((v) => ({ name: v.name, x: shown(over, found[over.name]), y: shown(v, found[v.name]) }));
    const first = quantities[0];
    if (now[over.name] * over.factor <= Math.max(...series[0].x, 0) && now[over.name] >= 0)
      quantities.forEach((v, k) => series.push({ name: "at the sliders", x: [now[over.name] * over.factor], y: [now[v.name] * v.factor], marks: "full", size: 5, colour: COLOURS[k], quiet: k > 0, titles: [`${v.name} at the sliders`] }));
    series.push(...this.published(over, quantities), ...this.measured(over, quantities, lab), ...dropped(lab.file, over, first, false));
    const log = series.some((s) => s.faint);
    chart.draw(series, { label: label(over), log }, { label: quantities.length > 1 ? `[${unitText(first.shown)}]` : label(first), log });
  }

  published(over, quantities) {
    const fitting = this.joint.about.points.filter((p) => over.name in p.at && quantities.some((v) => v.name === p.output));
    const roles = [...new Set(fitting.map((p) => p.role))];
    return roles.map((role) => {
      const some = fitting.filter((p) => p.role === role);
      return { name: `published: ${some[0].doc}`, marks: role === "calibration" ? "empty" : "full", colour: "var(--ink)",
        x: some.map((p) => p.at[over.name] * over.factor), y: some.map((p) => p.value * this.joint.variables.get(p.output).factor), titles: some.map((p) => `${p.id}: ${p.place}`) };
    });
  }

  measured(over, quantities, lab) {
    const some = this.joint.about.measured.filter((m) => m.abscissa === over.name && quantities.some((v) => v.name === m.ordinate));
    return some.map((m, k) => {
      const v = this.joint.variables.get(m.ordinate), times = lab.values.get(m.scale_parameter) * v.factor;
      return { name: k ? `measured: ${m.label}` : "measured joints, each named in the table", quiet: k > 0, titles: m.x.map(() => `measured: ${m.label} (${m.source})`), x: shown(over, m.x), y: m.y.map((y) => y * times), dashed: true, faint: true, colour: `hsl(${(k * 67) % 360} 35% 55%)` };
    });
  }
}

/** The curve of a dropped file over two variables that measure what it measures; as it goes round if `free`. */
function dropped(file, one, other, free) {
  if (!file) return [];
  const [x, y] = [one, other].map((v) => file.columns.find((c) => c.base === v.unit && !(free && c.used)));
  if (!x || !y || x === y) return [];
  return [{ name: `file: ${file.name}`, x: shown(one, x.values), y: shown(other, y.values), marks: "empty", size: 2.5, colour: "var(--violet)" }];
}
