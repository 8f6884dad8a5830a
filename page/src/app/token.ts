// By path, because editors behind a proxy share one origin, and frames in one tab share its storage.
const key = `meshgraft.token ${location.pathname}`;

/**
 * Returns the token of the address, and takes it out of the address bar and the history. After a reload, returns the
 * token that the tab remembers; without one, an empty text.
 */
export function takeToken(): string {
  const query = new URLSearchParams(location.search);
  const given = query.get("token");
  try {
    if (given === null) return sessionStorage.getItem(key) ?? "";
    sessionStorage.setItem(key, given);
  } catch {
    return given ?? ""; // the browser keeps nothing: the token stays in the address for a reload
  }
  query.delete("token");
  const rest = query.size === 0 ? "" : `?${query.toString()}`;
  history.replaceState(history.state, "", location.pathname + rest + location.hash);
  return given;
}
