/* Sliders: one for each parameter and input, from the list of variables. */

/** From a slider's 0 to 1000 to the SI value, and back; logarithmic where the span is wide. */
const onScale = (v, t) => {
  const [low, high] = v.span;
  const x = v.log ? low * (high / low) ** (t / 1000) : low + ((high - low) * t) / 1000;
  return v.whole ? Math.round(x) : Number(x.toPrecision(6));
};
const scaled = (v, x) => {
  const [low, high] = v.span;
  const t = v.log ? Math.log(x / low) / Math.log(high / low) : (x - low) / (high - low);
  return Math.round(1000 * Math.min(1, Math.max(0, t)));
};

/** The ends of the part of a slider's span, around its value, that the joint takes, all other values as they are. */
function allowed(joint, values, v) {
  const here = values.get(v.name), said = new Set(joint.messages);
  const between = (a, b, t) => {
    const x = v.log && a > 0 && b > 0 ? a * (b / a) ** t : a + t * (b - a);
    return v.whole ? Math.round(x) : Number(x.toPrecision(6));
  };
  const takes = (x) => joint.begin(new Map(values).set(v.name, x));
  const ends = v.span.map((end) => {
    let [good, bad] = [here, NaN];
    for (const x of [between(here, end, 0.5), between(here, end, 1)]) {
      if (takes(x)) good = x;
      else { bad = x; break; }
    }
    for (let i = 0; i < 12 && !Number.isNaN(bad); i++) {
      const x = between(good, bad, 0.5);
      if (takes(x)) good = x;
      else bad = x;
    }
    return good;
  });
  joint.messages = said;
  return ends;
}

/** A labelled slider with a number beside it; `change` gets the SI value. */
class Control {
  constructor(v, value, change) {
    const id = `set-${v.name.replaceAll(/[. ]/g, "-")}`;
    [this.v, this.full, this.first, this.change] = [v, v, value, change];
    const unit = unitText(v.shown);
    this.range = element("input", { type: "range", min: 0, max: 1000, step: 1, id: `${id}-slider`, "aria-label": `${v.name}, ${v.doc}`,
      oninput: () => this.moved(onScale(this.v, Number(this.range.value)), this.range) });
    this.number = element("input", { type: "number", step: "any", id, "aria-describedby": `${id}-doc`,
      oninput: () => this.number.value !== "" && this.moved(Number(this.number.value) / v.factor, this.number) });
    this.node = element("div", { class: "control" },
      element("label", { for: id }, element("b", {}, v.name)),
      element("span", { class: "doc", id: `${id}-doc` }, v.doc), this.range,
      element("span", { class: "entry" }, this.number, element("span", { class: "unit" }, unit)));
    this.show(value);
  }

  moved(value, by) {
    this.show(value, by);
    this.change(value);
  }

  /** A slider that goes over a part of its span; without room it rests. */
  fit([low, high]) {
    this.v = { ...this.full, span: [low, high], log: this.full.log && low > 0 && high > 5 * low };
    this.range.disabled = !(low < high);
    this.show(this.value, this.number);
  }

  show(value, except) {
    this.value = value;
    if (except !== this.number) this.number.value = entered(value * this.v.factor);
    if (except !== this.range) this.range.value = scaled(this.v, value);
    this.range.setAttribute("aria-valuetext", `${digits(value * this.v.factor)} ${unitText(this.v.shown)}`);
  }
}

/** The same for yes and no. */
class Switch {
  constructor(v, value, change) {
    const id = `set-${v.name.replaceAll(".", "-")}`;
    this.box = element("input", { type: "checkbox", id, onchange: () => change(this.box.checked) });
    this.node = element("div", { class: "control switch" }, this.box, element("label", { for: id }, element("b", {}, v.name)), element("span", { class: "doc" }, v.doc));
    this.show(value);
  }

  show(value) {
    this.box.checked = Boolean(value);
  }
}

/** Whether a variable stands for a temperature. */
const warm = (v) => v.unit === "K" || v.unit === "degC" || /^temperature/.test(v.name);

/** What a variable is sorted under: [title, whether it is open at first]. */
function groupOf(v, about) {
  if (v.causality === "input") return /\/s$/.test(v.unit) ? ["Speeds", false] : ["Load and motion", true];
  if (warm(v)) return ["Temperature", true];
  const section = v.name.includes(".") ? v.name.split(".")[0] : "";
  if (about.surfaces.includes(section) || /rough|height of|surface/.test(v.doc) && !section) return ["Surface", true];
  if (/kinematic|^error/.test(`${v.name} ${v.doc}`) && !section) return ["Kinematic error", true];
  if (/friction|slip|hysteresis|lost motion|damp/.test(`${v.name.replaceAll("_", " ")} ${v.doc}`) && !section) return ["Friction, play and damping", true];
  return section ? [section, false] : ["Joint", false];
}

/** Fill a place with the controls of a joint; gives { name: control }. */
function controls(place, about, values, change) {
  const groups = new Map(), made = {}, wide = matchMedia("(min-width: 980px)").matches;
  for (const v of about.variables) {
    if (v.causality === "output" || v.bound) continue;
    const [title, open] = groupOf(v, about);
    if (!groups.has(title)) groups.set(title, element("details", { open: open && wide, class: "group" }, element("summary", {}, title)));
    const control = new (v.boolean ? Switch : Control)(v, values.get(v.name), (value) => change(v.name, value));
    made[v.name] = control;
    groups.get(title).append(control.node);
  }
  const order = ["Load and motion", "Temperature", "Surface", "Friction, play and damping", "Kinematic error"];
  const rank = (title) => (order.includes(title) ? order.indexOf(title) : order.length);
  const sorted = [...groups].sort(([a], [b]) => rank(a) - rank(b));
  place.replaceChildren(...sorted.map(([, node]) => node));
  return made;
}
