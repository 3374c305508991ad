// What is said before a mission is uploaded: it replaces the one on board.

export function replaces(words, snapshot) {
  const count = snapshot?.mission?.count;
  if (count === undefined || count === 0) return "";
  return words.say(count === 1 ? "mission.replaces_one" : "mission.replaces", { count: words.number(count) });
}
