// A voyage in words.

// Hours, minutes and seconds since the log's beginning.
export function clock(seconds) {
  const s = Math.max(0, Math.round(seconds));
  const two = (n) => String(n).padStart(2, "0");
  const hours = Math.floor(s / 3600);
  return `${hours ? `${hours}:${two(Math.floor(s / 60) % 60)}` : Math.floor(s / 60)}:${two(s % 60)}`;
}

export const size = (bytes, words) =>
  bytes < 999_500
    ? words.say("logs.kb", { n: words.number(bytes / 1000, bytes < 9_950 ? 1 : 0) })
    : words.say("unit.mb", { n: words.number(bytes / 1e6, bytes < 99.5e6 ? 1 : 0) });

const known = (values) => values.filter((one) => one !== null);

// [key, value] of the figures of a voyage; those unknown are left out.
export function figures(voyage, words) {
  const percents = known(voyage.percents);
  const volts = known(voyage.voltages_v);
  const obstacles = known(voyage.obstacles_m);
  return [
    ["logs.distance", words.distance(voyage.distance_m)],
    ["logs.duration", words.duration(voyage.duration_s)],
    ["logs.fastest", voyage.largest_speed_m_s === null ? null : words.speed(voyage.largest_speed_m_s)],
    ["logs.off_course", voyage.largest_cross_track_m === null ? null : words.distance(voyage.largest_cross_track_m)],
    ["logs.charge", percents.length === 0 ? null : words.percent((percents[0] - percents[percents.length - 1]) / 100)],
    ["logs.lowest", volts.length === 0 ? null : words.say("unit.v", { n: words.number(Math.min(...volts), 1) })],
    ["logs.nearest", obstacles.length === 0 ? null : words.distance(Math.min(...obstacles))],
  ].filter(([, value]) => value !== null);
}

export function eventText({ kind, text }, words) {
  if (kind === "mode") return words.say("logs.event.mode", { mode: words.sayOr(`mode.${text}`, text) });
  if (kind === "armed" || kind === "disarmed") return words.say(`logs.event.${kind}`);
  return text;
}

// A moment of the voyage.
export function momentText(voyage, index, words) {
  const [speed, wanted, volts, percent] = ["speeds_m_s", "wanted_m_s", "voltages_v", "percents"].map((name) => voyage[name][index]);
  const mode = voyage.events.filter((one) => one.kind === "mode" && one.at_s <= voyage.times_s[index] + 0.05).pop();
  return [
    clock(voyage.times_s[index]),
    mode && words.sayOr(`mode.${mode.text}`, mode.text),
    speed !== null && words.speed(speed),
    wanted !== null && words.say("logs.wanted_now", { speed: words.speed(wanted) }),
    volts !== null && words.say("unit.v", { n: words.number(volts, 2) }),
    percent !== null && words.percent(percent / 100),
  ].filter(Boolean).join(", ");
}

// The whole voyage in sentences, for those who do not see the pictures.
export function summary(voyage, words) {
  const count = (kind) => voyage.events.filter((one) => one.kind === kind).length;
  const said = figures(voyage, words).map(([key, value]) => `${words.say(key)}: ${value}`);
  const modes = voyage.events.filter((one) => one.kind === "mode").map((one) => `${clock(one.at_s)} ${words.sayOr(`mode.${one.text}`, one.text)}`);
  return [
    `${said.join("; ")}.`,
    modes.length > 0 ? words.say("logs.modes", { modes: modes.slice(0, 12).join(", ") }) : "",
    words.say("logs.counts", { errors: count("error"), messages: count("message") }),
  ].filter(Boolean).join(" ");
}
