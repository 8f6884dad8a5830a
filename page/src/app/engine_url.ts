/** Returns the address of something of the engine's, beside the page: a proxy may serve both below a path of its own. */
export function engineUrl(name: string, query: Readonly<Record<string, string>>, scheme: "http" | "ws" = "http"): string {
  const url = new URL(name, location.href);
  if (scheme === "ws") url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  url.search = new URLSearchParams(query).toString();
  return url.href;
}
