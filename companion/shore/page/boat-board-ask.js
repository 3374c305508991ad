// Requests of the board panel by HTTP, each answered by {ok, text, body}.

const LOST = { ok: false, text: null, body: null };

export async function askBoard(words, path, options = {}) {
  try {
    const answer = await fetch(`/api/board${path}`, { signal: AbortSignal.timeout?.(120_000), ...options });
    const body = await answer.json();
    return { ok: answer.ok, status: answer.status, text: words.refusal(body) || null, body };
  } catch {
    return LOST;
  }
}

export const postBoard = (words, path, content) =>
  askBoard(words, path, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(content) });
