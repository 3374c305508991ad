// Something fetched again and again while it is looked at.

// look(isCurrent): fetches and shows; isCurrent(): nobody has closed or opened it meanwhile. Returns what a panel hears.
export function polled(period_ms, look) {
  let timer = null;
  let watch = 0; // an answer to an earlier opening is dropped

  const again = async (own) => {
    await look(() => own === watch);
    if (own === watch) timer = setTimeout(again, period_ms, own);
  };
  const stop = () => {
    watch += 1;
    clearTimeout(timer);
  };
  return {
    opened() {
      stop();
      again(watch);
    },
    closed: stop,
  };
}
