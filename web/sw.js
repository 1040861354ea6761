/**
 * The service worker: keeps the files of one build on this device and answers with them, so that the page
 * works without a network and loads at once. All files of a build belong together, so nothing is mixed: a newer build waits,
 * complete, until the visitor asks for it.
 *
 * In the sources the list is empty, and the worker does away with itself and what an earlier build left:
 * who develops sees files, not memories of them.
 */
// The build writes its number and its files here.
const build = { id: "development", files: [] };

const PREFIX = "stepscope-";
const own = PREFIX + build.id;
const worker = /** @type {any} */ (self);

/** @param {any} event */
worker.oninstall = (event) => event.waitUntil(install());
/** @param {any} event */
worker.onactivate = (event) => event.waitUntil(activate());
/** @param {any} event */
worker.onfetch = (event) => {
  const { request } = event;
  if (build.files.length > 0 && request.method === "GET" && request.url.startsWith(worker.registration.scope))
    event.respondWith(answer(request));
};
/** The page asks to change over. @param {any} event */
worker.onmessage = ({ data }) => {
  if (data === "take over") worker.skipWaiting();
};

async function install() {
  if (build.files.length === 0) return worker.skipWaiting();
  const cache = await caches.open(own);
  await Promise.all(
    build.files.map(async (/** @type {string} */ file) => {
      const url = new URL(file, worker.registration.scope).href;
      const hashed = file.startsWith("assets/");
      // The name of a file with a hash says what it holds: an earlier build's is the same.
      const kept = hashed && (await caches.match(url));
      const response = kept || (await fetch(url, { cache: hashed ? "default" : "no-cache" }));
      if (!response.ok) throw new Error(`${file}: ${response.status}`);
      // Some hosts send pages to names of their own; what came over a detour may not answer for a page.
      await cache.put(url, response.redirected ? new Response(response.body, { headers: response.headers }) : response);
    }),
  );
}

async function activate() {
  for (const name of await caches.keys()) {
    if (name.startsWith(PREFIX) && name !== own) await caches.delete(name);
  }
  if (build.files.length === 0) return worker.registration.unregister();
  // Also the page of the very first visit is offline-proof from now on.
  await worker.clients.claim();
}

/** @param {Request} request */
async function answer(request) {
  const url = new URL(request.url);
  url.search = url.hash = "";
  if (request.mode === "navigate") url.pathname = url.pathname.replace(/\/index\.html$/, "/");
  const cache = await caches.open(own);
  return (await cache.match(url.href)) ?? fetch(request);
}
