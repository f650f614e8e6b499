/* Parameter files out of the page and into it, and measured curves from CSV files. */

const tomlNumber = (x) => (typeof x === "boolean" ? String(x) : Number.isInteger(x) && Math.abs(x) < 1e15 ? `${x}.0` : String(x));
const ENTRY = /^(\w+)(\s*=\s*\{\s*value\s*=\s*)([^,}\[]+?)(\s*[,}].*)$/;

/** The text of a parameter set with other values; units stay, changed entries come from the user. */
function written(set, about, values) {
  const units = new Map(about.variables.map((v) => [v.name, v.unit]));
  const entry = (leaf, name) => `${leaf} = { value = ${tomlNumber(values.get(name))}, ${typeof values.get(name) === "boolean" ? "" : `unit = "${units.get(name)}", `}kind = "user", source = "set in the laboratory" }`;
  const lines = [];
  let section = "";
  for (const line of set.toml.split("\n")) {
    const head = line.match(/^\[(.+)\]$/);
    if (head) section = head[1];
    if (section === "inputs") continue;
    const [, leaf] = line.match(ENTRY) || [];
    const name = section ? `${section}.${leaf}` : leaf;
    lines.push(leaf && name in set.values && values.get(name) !== set.values[name] ? entry(leaf, name) : line);
  }
  while (lines.at(-1) === "") lines.pop();
  const inputs = Object.keys(set.inputs).filter((name) => values.get(name) !== 0);
  if (inputs.length) lines.push("", "[inputs]", ...inputs.map((name) => entry(name, name)));
  return lines.join("\n") + "\n";
}

const FIELD = /\s*(\w+)\s*=\s*("(?:[^"\\]|\\.)*"|\[[^\]]*\]|[^,}\s"[\]]+)\s*(,\s*\}?|\})/y;

/** A value of TOML: number, boolean, text without escapes, or a list of numbers. */
function tomlValue(raw, name) {
  if (raw === "true" || raw === "false") return raw === "true";
  if (raw.startsWith('"')) return raw.slice(1, -1);
  if (raw.startsWith("[")) return raw.slice(1, -1).split(",").map((x) => x.trim()).filter(Boolean).map((x) => tomlValue(x, name));
  const number = Number(raw.replaceAll("_", ""));
  if (!Number.isFinite(number)) throw new Error(`${name} = ${raw} is no number`);
  return number;
}

/** { joint, law, name, values, units } of a parameter file as the package writes it; an Error at any other line. */
function readToml(text) {
  const found = { values: new Map(), units: new Map() };
  let section = "", rest = text.replaceAll("\r\n", "\n");
  while ((rest = rest.replace(/^(\s+|#[^\n]*)+/, ""))) {
    const [line] = rest.match(/^[^\n]*/), head = line.match(/^\[([\w.]+)\]\s*(#.*)?$/);
    const top = line.match(/^(schema|joint|law|name)\s*=\s*("[^"]*"|\d+)\s*(#.*)?$/), entry = rest.match(/^(\w+)\s*=\s*\{/);
    if (head) section = head[1];
    else if (top && !section) found[top[1]] = tomlValue(top[2], top[1]);
    else if (entry) {
      const name = section && section !== "inputs" ? `${section}.${entry[1]}` : entry[1], fields = {};
      FIELD.lastIndex = entry[0].length;
      for (let closed = false; !closed; ) {
        const field = FIELD.exec(rest);
        if (!field) throw new Error(`the entry ${name} cannot be read; expected ${entry[1]} = { value = ..., unit = "..." }`);
        fields[field[1]] = field[2];
        closed = field[3].endsWith("}");
        if (closed) rest = rest.slice(FIELD.lastIndex);
      }
      if (!("value" in fields) || found.values.has(name)) throw new Error(`${name} has ${"value" in fields ? "two entries" : "no value"}; expected one`);
      found.values.set(name, tomlValue(fields.value, name));
      if (fields.unit) found.units.set(name, tomlValue(fields.unit, name));
      continue;
    } else throw new Error(`the line ${line.slice(0, 60)} is not known here; expected a parameter file as jointfmu writes it`);
    rest = rest.slice(line.length);
  }
  if (!found.joint) throw new Error('no line joint = "..."; expected a parameter file');
  return found;
}

/** Why the module `about` cannot compute the joint of a file, in one line; nothing if it can. */
function findDifference(file, about) {
  const set = about.sets[0], own = readToml(set.toml).values, variables = new Map(about.variables.map((v) => [v.name, v]));
  const brief = (value) => (Array.isArray(value) ? `a list of ${value.length} numbers` : String(value).slice(0, 60));
  for (const [name, value] of file.values) {
    const v = variables.get(name), settable = name in set.values || name in set.inputs;
    if (settable && typeof value !== (v.boolean ? "boolean" : "number")) return `${name} = ${brief(value)} is no ${v.boolean ? "true or false" : "number"}`;
    if (settable && !v.boolean && file.units.get(name) !== v.unit) return `${name} has the unit ${file.units.get(name) ?? "none"}, expected ${v.unit}`;
    if (settable && !v.bound) continue;
    const here = settable ? set.values[name] : own.get(name);
    if (JSON.stringify(here) !== JSON.stringify(value)) return `${name} = ${brief(value)} cannot be set in this page, which has ${here === undefined ? "none" : Array.isArray(here) ? "another list" : brief(here)}`;
  }
  const missing = [...own.keys()].find((name) => !(name in set.inputs) && !file.values.has(name));
  return missing && `${missing} is missing, and the page does not know its default`;
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
      if (!row[k] || Number.isNaN(number)) throw new Error(`row ${i + 2}: ${c.name} = ${row[k] || "nothing"} is no number`);
      c.values.push(number * c.size);
    });
  }
  return { name, columns: used };
}
