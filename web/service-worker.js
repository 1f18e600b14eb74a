// Keeps the page where it was opened once, so that it opens without a network.

const CACHE = "pathwright-{{version}}";
const FILES = [
  "./",
/* {{files}} */];

// Pages of the version before keep their files: the new one takes over when they are closed.
addEventListener("install", (event) => {
  event.waitUntil(caches.open(CACHE).then((cache) => cache.addAll(FILES)));
});

addEventListener("activate", (event) => {
  const old = (names) => names.filter((name) => name.startsWith("pathwright-") && name !== CACHE);
  event.waitUntil(caches.keys().then((names) => Promise.all(old(names).map((name) => caches.delete(name)))).then(() => clients.claim()));
});

/** Page and workers among themselves, with nobody else's: so browsers let them share memory, which threads need. */
function isolated(response) {
  if (response.status === 0) return response;
  const headers = new Headers(response.headers);
  headers.set("Cross-Origin-Opener-Policy", "same-origin");
  headers.set("Cross-Origin-Embedder-Policy", "require-corp");
  return new Response(response.body, { status: response.status, statusText: response.statusText, headers });
}

/** What is kept; the page itself from the network where that answers, so that a new version is seen. */
async function answer(request) {
  const kept = () => caches.match(request, { ignoreSearch: true });
  if (request.mode !== "navigate") return (await kept()) ?? fetch(request);
  return fetch(request).catch(async () => (await kept()) ?? caches.match("./"));
}

addEventListener("fetch", (event) => {
  const { request } = event;
  if (request.method !== "GET" || new URL(request.url).origin !== location.origin) return;
  const hasScript = ["document", "worker"].includes(request.destination);
  event.respondWith(hasScript ? answer(request).then(isolated) : answer(request));
});
