// Addresses. A view is #/NAME/ARGUMENT?QUERY, so that each is a link that can be shared, on any web
// server.

let onRoute = () => {};

// Text that is not encoded well stays as it is, and then names no view or no run.
function decode(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

export function parse(hash) {
  const [path, query = ""] = hash.replace(/^#?\/?/, "").split("?");
  const [name = "", argument = ""] = path.split("/").map(decode);
  return { name: name || "runs", argument, query: new URLSearchParams(query) };
}

export function address(name, argument = "", query = {}) {
  const pairs = Object.entries(query).filter(([, value]) => value !== "" && value !== null && value !== undefined);
  const text = pairs.map(([key, value]) => `${key}=${encodeURIComponent(value).replaceAll("%2C", ",")}`).join("&");
  const path = [name, argument].filter(Boolean).map(encodeURIComponent).join("/");
  return `#/${path}${text ? `?${text}` : ""}`;
}

export function go(target) {
  location.hash = target;
}

// Another query for the view that is shown, without notifying it and without an entry in the history.
export function note(query) {
  const { name, argument, query: old } = parse(location.hash);
  const target = address(name, argument, { ...Object.fromEntries(old), ...query });
  if (target !== location.hash) history.replaceState(null, "", target);
}

export function startRouter(listener) {
  onRoute = () => listener(parse(location.hash));
  addEventListener("hashchange", onRoute);
  onRoute();
}
