/* Parameter files out of the page and into it, and measured curves from CSV files. */

/** Numbers of a list on a line of a file, and in a message. */
const [PER_LINE, LISTED] = [5, 3];
/** Largest span of a measured wind-up [rad]. */
const MAX_WIND_UP = 0.5;
const SCHEMA = 1, INPUTS = "inputs.", ROUGHNESS = "roughness.";
const ENTRY_KEYS = ["value", "unit", "kind", "source", "range"];

const tomlText = (text) => JSON.stringify(text).replaceAll("\x7f", "\\u007f");
const tomlNumber = (x) => (Number.isInteger(x) && Math.abs(x) < 1e15 ? `${x}.0` : String(x));
function tomlValue(x) {
  if (!Array.isArray(x)) return typeof x === "number" ? tomlNumber(x) : typeof x === "string" ? tomlText(x) : String(x);
  const lines = Array.from({ length: Math.ceil(x.length / PER_LINE) }, (_, i) => x.slice(PER_LINE * i, PER_LINE * (i + 1)).map(tomlNumber).join(", "));
  return `[\n  ${lines.join(",\n  ")},\n]`;
}

/** A value in a message. */
function told(value, unit) {
  if (value === undefined || value === null) return "nothing";
  if (Array.isArray(value)) return `[${value.slice(0, LISTED).map((x) => told(x)).join(", ")}${value.length > LISTED ? ", ..." : ""}] (${value.length} numbers)`;
  if (typeof value === "object") return "a table";
  return typeof value === "number" ? `${value}${unit && unit !== "1" ? ` ${unit}` : ""}` : JSON.stringify(value);
}

/**
 * The tables of a TOML document, as objects without a prototype.
 * An Error for what is not TOML, and for what no parameter file has: dates, tables in lists, texts of several lines, numbers of another base.
 */
function parseToml(text) {
  const source = text.replace(/^\ufeff/, ""), root = Object.create(null), headed = new Set(), closed = new WeakSet();
  let at = 0;
  const fail = (expected) => { throw new Error(`line ${source.slice(0, at).split("\n").length}: expected ${expected}`); };
  const take = (pattern) => {
    pattern.lastIndex = at;
    const found = pattern.exec(source);
    if (found) at = pattern.lastIndex;
    return found;
  };
  const blank = () => take(/[ \t]*/y), gap = () => take(/(?:[ \t\r\n]|#[^\n]*)*/y);
  const must = (pattern, expected) => take(pattern) ?? fail(expected);
  const text_ = () => {
    if (/^("""|''')/.test(source.slice(at, at + 3))) fail("a text on one line");
    const literal = take(/'([^'\n]*)'/y);
    if (literal) return literal[1];
    const found = take(/"(?:[^"\\\n]|\\(?:[btnfr"\\]|u[0-9a-fA-F]{4}|U[0-9a-fA-F]{8}))*"/y);
    return found && JSON.parse(found[0].replace(/\\U([0-9a-fA-F]{8})/g, (_, code) => String.fromCodePoint(parseInt(code, 16))));
  };
  const keys = () => {
    const found = [];
    do {
      blank();
      found.push(take(/[\w-]+/y)?.[0] ?? text_() ?? fail("a name"));
      blank();
    } while (take(/\./y));
    return found;
  };
  const inner = (table, names) => names.reduce((here, name) => {
    here[name] ??= Object.create(null);
    if (typeof here[name] !== "object" || Array.isArray(here[name]) || closed.has(here[name])) fail(`${name} once`);
    return here[name];
  }, table);
  const pair = (table) => {
    const names = keys(), last = names.pop(), place = inner(table, names);
    must(/=/y, `= after ${last}`);
    blank();
    if (last in place) fail(`${last} once; it is there twice`);
    place[last] = value();
  };
  const items = (end, one) => {
    const spaces = end === "]" ? gap : blank;
    for (spaces(); source[at] !== end; spaces()) {
      one();
      spaces();
      if (source[at] !== end) must(/,/y, `, or ${end}`);
    }
    at += 1;
  };
  const value = () => {
    if (take(/\[/y)) {
      const list = [];
      items("]", () => list.push(value()));
      return list;
    }
    if (take(/\{/y)) {
      const table = Object.create(null);
      items("}", () => pair(table));
      closed.add(table);
      return table;
    }
    const found = take(/(true|false|[+-]?(?:inf|nan|(?:0|[1-9](?:_?\d)*)(?:\.\d(?:_?\d)*)?(?:[eE][+-]?\d(?:_?\d)*)?))(?=[\s,\]}#]|$)/y);
    if (!found) return text_() ?? fail("a number, a text, true, false, a list or a table");
    if (/[tl]/.test(found[0])) return found[0] === "true";
    return Number(found[0].replaceAll("_", "").replace("inf", "Infinity").replace("nan", "NaN"));
  };
  let table = root;
  for (gap(); at < source.length; gap()) {
    if (take(/\[(?!\[)/y)) {
      const names = keys(), name = names.join("\0");
      must(/\]/y, "]");
      if (headed.has(name)) fail(`[${names.join(".")}] once; it is there twice`);
      headed.add(name);
      table = inner(root, names);
    } else pair(table);
    blank();
    must(/#[^\n]*|\r?\n|$/y, "the end of the line");
  }
  return root;
}

/** [structured name, entry] of a table's entries, as the package finds them. */
function leaves(table, prefix = "") {
  return Object.entries(table).flatMap(([key, item]) => {
    const group = item && typeof item === "object" && !Array.isArray(item) && Object.keys(item).length && !("value" in item);
    return group ? leaves(item, `${prefix}${key}.`) : [[prefix + key, item]];
  });
}

/** { joint, law, name, entries } of a parameter file, whose entries are a Map; an Error if it is none. */
function readToml(text) {
  const { schema, joint, law, name, ...body } = parseToml(text);
  if (schema !== SCHEMA) throw new Error(schema === undefined ? `schema is missing; expected a parameter file, schema = ${SCHEMA}` : `schema = ${told(schema)}, expected ${SCHEMA}`);
  return { joint, law, name, entries: new Map(leaves(body)) };
}

/** What is wrong with an entry, whatever joint it is of: one line; nothing if all is well. */
function faultOf(name, entry, own, origins) {
  if (!entry || typeof entry !== "object" || Array.isArray(entry)) return `${name} = ${told(entry)}, expected { value, unit, kind, source }`;
  const unknown = Object.keys(entry).find((key) => !ENTRY_KEYS.includes(key));
  if (unknown) return `${name} has an unknown key ${unknown}, allowed are ${ENTRY_KEYS.join(", ")}`;
  if (!origins.includes(entry.kind)) return `${name}: kind = ${told(entry.kind)}, allowed are ${origins.join(", ")}`;
  if (typeof entry.source !== "string" || !entry.source.trim()) return `${name}: source = ${told(entry.source)}, state where the value comes from`;
  if (!own) return "";
  if ((entry.unit ?? null) !== own.unit) return `${name}: unit ${told(entry.unit)}, expected ${told(own.unit)}`;
  const number = typeof entry.value === "number";
  if (own.unit && !Array.isArray(own.value) && !(number && Number.isFinite(entry.value))) return `${name} = ${told(entry.value, own.unit)}, expected a number`;
  if (typeof own.value === "boolean" && typeof entry.value !== "boolean") return `${name} = ${told(entry.value)}, allowed are true and false`;
  return outside(name, entry.value, own);
}

/** That a number lies outside the interval of its entry; nothing if it does not, or if the joint checks it. */
function outside(name, x, { interval, unit }) {
  if (!interval) return "";
  const [low, high, lowOpen, highOpen] = interval;
  const inside = (low === null || (lowOpen ? x > low : x >= low)) && (high === null || (highOpen ? x < high : x <= high));
  return inside ? "" : `${name} = ${told(x, unit)} is outside ${lowOpen ? "(" : "["}${low ?? "-inf"}, ${high ?? "inf"}${highOpen ? ")" : "]"}`;
}

/** Height of the law that roughnesses make: { height }, { fault } or nothing, as `roughness.height` of the package. */
function heightOf(file, { factor }) {
  const stated = Object.fromEntries([...file.entries].filter(([name]) => name.startsWith(ROUGHNESS)).map(([name, entry]) => [name.slice(ROUGHNESS.length), entry.value]));
  const names = Object.keys(stated);
  if (!names.length) return {};
  const twice = [["Rq1", "Ra1"], ["Rq2", "Ra2"], ...names.filter((name) => name !== "h").map((name) => ["h", name])].find((two) => two.every((name) => name in stated));
  if (twice) return { fault: `${ROUGHNESS}${twice[0]} with ${ROUGHNESS}${twice[1]}: state one height for each side, or only h` };
  const [first, second] = [1, 2].map((side) => stated[`Rq${side}`] ?? factor * (stated[`Ra${side}`] ?? 0));
  return { height: stated.h ?? Math.sqrt(first * first + second * second), makers: names.map((name) => `${ROUGHNESS}${name}`) };
}

const same = (one, other) => (Array.isArray(one) && Array.isArray(other) ? one.length === other.length && one.every((x, i) => x === other[i]) : one === other);

/**
 * A parameter file in a module: { values, fixed, inputs } of the joint that it states.
 * Else { faults }, lines that say what no joint may have, or { others }: [rank, line] of what this module has otherwise.
 */
function fitted(file, about, known) {
  const faults = [], others = [], [first] = about.sets, found = { values: {}, fixed: {}, inputs: {} };
  const bound = new Set(about.variables.filter((v) => v.bound).map((v) => v.name));
  const has = (name, value) => {
    const own = about.entries[name], input = name.startsWith(INPUTS) && name.slice(INPUTS.length);
    if (name in first.values && !bound.has(name)) found.values[name] = value;
    else if (input in first.inputs) found.inputs[input] = value; // those of other models of the joint act on none of this
    else if (about.fixed.includes(name)) found.fixed[name] = value;
    else if ("value" in own && !same(value, own.value)) others.push([typeof value === "string" ? 0 : bound.has(name) ? 3 : 2, `${name} = ${told(value, own.unit)}, but the page has only ${told(own.value, own.unit)}`]);
    else if (bound.has(name)) found.values[name] = value;
  };
  for (const [name, entry] of file.entries) {
    const own = about.entries[name], fault = faultOf(name, entry, own, known.origins);
    if (fault) faults.push(fault);
    else if (own) has(name, entry.value);
    else others.push([1, `${name} = ${told(entry.value, entry.unit)}, which this page does not have`]);
  }
  const made = faults.length || !about.height ? {} : heightOf(file, known.roughness), stated = file.entries.get(about.height)?.value;
  if (made.fault) faults.push(made.fault);
  if (made.height !== undefined && stated === undefined) found.values[about.height] = made.height;
  else if (made.height !== undefined && !(Math.abs(stated / made.height - 1) <= known.roughness.close)) faults.push(`${about.height} = ${told(stated, "m")} does not agree with ${made.makers.join(", ")}, which give ${digits(made.height)} m: state one of them, or both equal`);
  for (const [name, own] of Object.entries(about.entries)) {
    if (file.entries.has(name) || (name === about.height && made.height !== undefined)) continue;
    if ("default" in own) has(name, own.default);
    else if ("value" in own) faults.push(`${name} is missing`);
  }
  return { ...found, faults, others };
}

/**
 * { about, set } of the module that has the joint of a parameter file, best a model of the name `now`.
 * An Error with one line where none has: what in the file it is, and what shows this joint.
 */
function placed(text, fileName, known, now) {
  const file = readToml(text), joints = [...new Set(known.modules.map((m) => m.joint))];
  if (!joints.includes(file.joint)) throw new Error(`joint = ${told(file.joint)}, the page has ${joints.join(", ")}`);
  const some = known.modules.filter((m) => m.joint === file.joint), law = file.law ?? some.find((m) => m.default).law;
  const fitting = some.filter((m) => m.law === law).sort((a, b) => (b.name === now) - (a.name === now));
  if (!fitting.length) throw new Error(`law = ${told(law)}, the page has ${[...new Set(some.map((m) => m.law))].join(", ")}`);
  const tried = fitting.map((about) => ({ about, ...fitted(file, about, known) }));
  const found = tried.find(({ faults, others }) => !faults.length && !others.length);
  if (!found) {
    const { faults, others } = tried.reduce((best, one) => (one.others.length < best.others.length ? one : best));
    if (!others.length) throw new Error(faults[0]);
    const [[, line]] = others.sort(([a], [b]) => a - b), more = others.length - 1;
    throw new Error(`${line}${more ? `; ${more} more ${more > 1 ? "entries are" : "entry is"} of another joint` : ""}. What was shown stays. To see the joint of this file: jointfmu report ${fileName}`);
  }
  const { about, values, fixed, inputs } = found;
  return { about, set: { name: file.name ?? fileName.replace(/\.toml$/i, ""), values, fixed, inputs, toml: text, base: about.sets[0] } };
}

/** Where a value comes from that the user has set, and a load with which the page begins. */
const MOVED = { kind: "user", source: "set in the laboratory" }, BEGUN = { kind: "estimate", source: "the laboratory begins with a third of the load ramp" };

/** The text of a parameter set with other values: changed entries come from the user, a height stands in place of the roughnesses that made it. The values in `first` are those the page begins with. */
function written(set, about, values, first) {
  const { joint, law, name, entries } = readToml(set.toml);
  const put = (entry, value, origin = MOVED) => entries.set(entry, { value, unit: about.entries[entry].unit, ...origin });
  for (const [key, value] of [...Object.entries(set.values).map(([key]) => [key, values.get(key)]), ...Object.entries(set.fixed ?? {})]) {
    const now = entries.get(key)?.value;
    if (now === value || (now === undefined && value === set.values[key])) continue;
    put(key, value);
    if (key === about.height) for (const other of [...entries.keys()]) if (other.startsWith(ROUGHNESS)) entries.delete(other);
  }
  for (const key of Object.keys(set.inputs)) {
    const entry = `${INPUTS}${key}`, value = values.get(key);
    if (value === about.entries[entry].default) entries.delete(entry);
    else if (entries.get(entry)?.value !== value) put(entry, value, value === first.get(key) ? BEGUN : MOVED);
  }
  const sections = new Map([["", []]]);
  for (const [key, { value, unit, range, kind, source }] of entries) {
    const cut = key.lastIndexOf("."), section = key.slice(0, Math.max(cut, 0));
    if (!sections.has(section)) sections.set(section, []);
    const parts = [`value = ${tomlValue(value)}`, ...(unit ? [`unit = ${tomlText(unit)}`] : []), ...(range ? [`range = [${range.map(tomlNumber).join(", ")}]`] : []), `kind = ${tomlText(kind)}`, `source = ${tomlText(source)}`];
    sections.get(section).push(`${key.slice(cut + 1)} = { ${parts.join(", ")} }`);
  }
  const head = [`schema = ${SCHEMA}`, `joint = ${tomlText(joint)}`, `law = ${tomlText(law ?? about.law)}`, `name = ${tomlText(name ?? set.name)}`];
  return [...head, ...sections.get(""), ...[...sections].slice(1).flatMap(([section, lines]) => ["", `[${section}]`, ...lines])].join("\n") + "\n";
}

/** Largest number of a list minus the smallest one. */
function span(values) {
  const [low, high] = values.reduce((ends, x) => [Math.min(ends[0], x), Math.max(ends[1], x)], [Infinity, -Infinity]);
  return high - low;
}

/** { name, columns: [{ name, base, values }] } of a CSV file with a line of `name [unit]`; an Error if it is none. */
function readCsv(text, name, units) {
  const rows = text.split(/\r?\n/).filter((line) => line.trim() && !line.trim().startsWith("#"));
  const sign = rows.length && [";", "\t", ","].find((s) => rows[0].includes(s));
  if (!sign) throw new Error("no columns; expected a line such as angle [arcmin], torque [N.m]");
  const cells = (line) => line.split(sign).map((cell) => cell.trim());
  const columns = cells(rows[0]).map((head) => {
    const unit = head.match(/\[(.+)\]/)?.[1].replaceAll(/[ *·]/g, ".").replace(/^(k|m)?Nm$/, "$1N.m") ?? "";
    const base = Object.keys(units).find((base) => unit in units[base]);
    return base && { name: head, base, size: units[base][unit], values: [] };
  });
  const used = columns.filter((c) => c && !/^run\b/.test(c.name));
  if (!["rad", "m"].some((b) => used.some((c) => c.base === b)) || !["N.m", "N"].some((b) => used.some((c) => c.base === b)))
    throw new Error(`columns ${cells(rows[0]).join(", ")}; expected one in ${Object.keys(units.rad).join(", ")} or ${Object.keys(units.m).join(", ")} and one in ${Object.keys(units["N.m"]).join(", ")} or ${Object.keys(units.N).join(", ")}`);
  for (const [i, line] of rows.slice(1).entries()) {
    const row = cells(line);
    columns.forEach((c, k) => {
      if (!c) return;
      const number = Number(sign === ";" ? row[k]?.replace(",", ".") : row[k]);
      if (!row[k] || Number.isNaN(number)) throw new Error(`row ${i + 2}: ${c.name} = ${row[k] || "nothing"} is not a number`);
      c.values.push(number * c.size);
    });
  }
  const log = cells(rows[0]).find((head) => /\[\s*(m?A|\S+\/s|rev\/min)\s*\]/.test(head));
  const wide = used.find((c) => c.base === "rad" && span(c.values) > MAX_WIND_UP);
  if (log || wide)
    throw new Error(`${log ? `column ${log}` : `${wide.name} spans more than ${MAX_WIND_UP} rad`}: a log of a motion is no curve of the joint; expected a wind-up and a torque. Fit a robot's log with: jointfmu fit log`);
  return { name, columns: used };
}
