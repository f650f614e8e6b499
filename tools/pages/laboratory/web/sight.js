/* What the reader sees of the page. */

/** Which places are in the window, or nearly so. */
class Sight {
  constructor() {
    this.seen = new Set();
    this.known = new Set();
    this.watcher = new IntersectionObserver((changes) => {
      for (const { target, isIntersecting } of changes) this.seen[isIntersecting ? "add" : "delete"](target);
    }, { rootMargin: "100px" });
  }

  /** A place that was never asked for counts as seen. */
  sees(place) {
    if (this.known.has(place)) return this.seen.has(place);
    this.known.add(place);
    this.watcher.observe(place);
    return true;
  }
}
