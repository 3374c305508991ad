// The PIN makes a viewer a skipper; the session is a cookie, so the socket is opened anew.

export function wirePin(page, words, live, tell) {
  page.form.addEventListener("submit", async (event) => {
    event.preventDefault();
    const pin = page.field.value;
    if (!pin) return;
    page.field.value = "";
    page.submit.disabled = true;
    tell(words.say("pin.asked"));
    try {
      const answer = await fetch("/api/session", {
        method: "POST",
        headers: { "Content-Type": "application/json" },
        body: JSON.stringify({ pin }),
      });
      if (answer.ok) {
        tell(words.say("pin.good"), true);
        live.connect();
      } else {
        tell((await refusal(answer, words)) ?? words.say("pin.bad"), false);
      }
    } catch {
      tell(words.say("pin.lost"), false);
    }
    page.submit.disabled = false;
  });
  page.lock.addEventListener("click", async () => {
    try {
      await fetch("/api/session", { method: "DELETE" });
      tell(words.say("pin.locked"));
    } catch {
      tell(words.say("pin.lost"), false);
    }
    live.connect();
  });
  return () => {
    page.form.hidden = live.isSkipper;
    page.lock.hidden = !live.isSkipper;
  };
}

// What the server says against it, or null.
export async function refusal(answer, words) {
  try {
    return words.refusal(await answer.json()) || null;
  } catch {
    return null;
  }
}
