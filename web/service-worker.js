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

/** What is kept; the page itself from the network where that answers, so that a new version is seen. */
async function answer(request) {
  const kept = () => caches.match(request, { ignoreSearch: true });
  if (request.mode !== "navigate") return (await kept()) ?? fetch(request);
  return fetch(request).catch(async () => (await kept()) ?? caches.match("./"));
}

addEventListener("fetch", (event) => {
  const { request } = event;
  if (request.method === "GET" && new URL(request.url).origin === location.origin) event.respondWith(answer(request));
});
