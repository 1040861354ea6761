/** Offline use from the second visit on, and the message about a newer version. */
import { byId } from "../dom.js";

/** Interval of checks for a newer version, in ms. */
const CHECK_MS = 3_600_000;

let isStarted = false;

/** Starts caching for offline use, after the first drawing so that it costs no time. A development build is not cached. */
export function cacheOffline() {
  if (isStarted) return;
  isStarted = true;
  if (!("serviceWorker" in navigator) || document.documentElement.dataset.build === "development") return;
  const { serviceWorker } = navigator;
  const notice = byId("newer-version");
  let isRequested = false;

  /** @param {ServiceWorkerRegistration} registration */
  const showIfWaiting = (registration) => {
    // Without a controller this is the first version on this device.
    if (registration.waiting && serviceWorker.controller) notice.hidden = false;
  };
  byId("reload").addEventListener("click", async () => {
    isRequested = true;
    const waiting = (await serviceWorker.getRegistration())?.waiting;
    if (waiting) waiting.postMessage("take over");
    else location.reload();
  });
  byId("not-now").addEventListener("click", () => {
    notice.hidden = true;
  });
  let controlled = serviceWorker.controller !== null;
  serviceWorker.addEventListener("controllerchange", () => {
    if (isRequested) location.reload();
    // Another tab activated a new version, so files of this one may be missing.
    else if (controlled) notice.hidden = false;
    controlled = true;
  });
  serviceWorker
    .register("sw.js", { updateViaCache: "none" })
    .then((registration) => {
      showIfWaiting(registration);
      registration.addEventListener("updatefound", () => {
        const next = registration.installing;
        next?.addEventListener("statechange", () => showIfWaiting(registration));
      });
      setInterval(() => registration.update().catch(() => {}), CHECK_MS);
      document.documentElement.dataset.offline = "asked";
    })
    .catch(() => {
      // Private windows and some hosts reject service workers; the page works without.
    });
}
