// RFC 7396 merge patch: returns what `whole` becomes; neither is changed.
export function merged(whole, patch) {
  if (patch === null || typeof patch !== "object" || Array.isArray(patch)) return patch;
  const kept = whole !== null && typeof whole === "object" && !Array.isArray(whole) ? whole : {};
  const result = { ...kept };
  for (const [name, value] of Object.entries(patch)) {
    if (value === null) delete result[name];
    else result[name] = merged(result[name], value);
  }
  return result;
}
