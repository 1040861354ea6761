/** Offline use from the second visit on, and the message about a newer version. */
import { byId } from "../dom.js";

/** How often a page that stays open requests a newer version, in ms. */
const ASK_MS = 3_600_000;

let begun = false;

/** Starts to keep the page, once it stands: that costs the first view nothing. The sources as they lie are not kept. */
export function cacheOffline() {
  if (begun) return;
  begun = true;
  if (!("serviceWorker" in navigator) || document.documentElement.dataset.build === "development") return;
  const { serviceWorker } = navigator;
  const notice = byId("newer-version");
  let isRequested = false;

  /** @param {ServiceWorkerRegistration} registration */
  const waits = (registration) => {
    // Without a controller it is the first version on this device, and none is newer.
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
    // Another tab changed over: this one's files may be gone.
    else if (controlled) notice.hidden = false;
    controlled = true;
  });
  serviceWorker
    .register("sw.js", { updateViaCache: "none" })
    .then((registration) => {
      waits(registration);
      registration.addEventListener("updatefound", () => {
        const next = registration.installing;
        next?.addEventListener("statechange", () => waits(registration));
      });
      setInterval(() => registration.update().catch(() => {}), ASK_MS);
      document.documentElement.dataset.offline = "asked";
    })
    .catch(() => {
      // Private windows and odd hosts refuse; the page works without.
    });
}
