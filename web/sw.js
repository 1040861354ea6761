/**
 * The service worker: caches all files of a build for offline use. A newer build waits until the user reloads.
 *
 * In the sources the list is empty, and the worker removes itself and earlier caches.
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
    event.respondWith(respond(request));
};
/** The page activates this build. @param {any} event */
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
      // A hashed name identifies the content, also in an earlier cache.
      const cached = hashed && (await caches.match(url));
      const response = cached || (await fetch(url, { cache: hashed ? "default" : "no-cache" }));
      if (!response.ok) throw new Error(`${file}: ${response.status}`);
      // A redirected response cannot be used for a page.
      await cache.put(url, response.redirected ? new Response(response.body, { headers: response.headers }) : response);
    }),
  );
}

async function activate() {
  for (const name of await caches.keys()) {
    if (name.startsWith(PREFIX) && name !== own) await caches.delete(name);
  }
  if (build.files.length === 0) return worker.registration.unregister();
  // Also serve the page of the first visit.
  await worker.clients.claim();
}

/** @param {Request} request */
async function respond(request) {
  const url = new URL(request.url);
  url.search = url.hash = "";
  if (request.mode === "navigate") url.pathname = url.pathname.replace(/\/index\.html$/, "/");
  const cache = await caches.open(own);
  return (await cache.match(url.href)) ?? fetch(request);
}
