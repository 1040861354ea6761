/** The gallery (gallery.js), which loads on demand. */
import { byId } from "../dom.js";

/** @param {import("./opening.js").Page} page */
export function createStart(page) {
  const dialog = /** @type {HTMLDialogElement} */ (byId("gallery"));
  const opener = /** @type {HTMLButtonElement} */ (byId("preset"));
  /** @type {Promise<() => void> | null} */
  let loading = null;
  opener.disabled = false;
  opener.addEventListener("click", async () => {
    try {
      loading ??= import("./gallery.js").then(({ createGallery }) => createGallery(page, dialog));
      const open = await loading;
      if (!dialog.open) open();
    } catch {
      loading = null;
      const text = "The presets could not be loaded. Check the network and try again.";
      page.dispatch({ type: "notice", notice: { kind: "error", text, location: null } });
    }
  });
  // A click outside the content has the dialog as its target.
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close();
  });
  /** @param {import("../state/types.js").State} state */
  const render = ({ opened }) => {
    if (opened > 0) byId("welcome").hidden = true;
  };
  return { render };
}
