/** Opens files (selected, dropped or pasted) and devices; loads open_file.js and live.js on demand. */
import { byId } from "../dom.js";

/** @param {import("./open_file.js").Given} page */
export function createImports(page) {
  const chooser = /** @type {HTMLInputElement} */ (byId("open-file"));
  const hint = byId("drop-hint");
  byId("open").addEventListener("click", () => chooser.click());
  byId("device").addEventListener("click", () =>
    attempt(async () => (await import("./live/live.js")).openDevice(page)),
  );
  chooser.addEventListener("change", () => {
    const [file] = chooser.files ?? [];
    chooser.value = "";
    if (file) open([file]);
  });

  /** Whether the drag started in the page, such as a selected text. */
  let isInternalDrag = false;
  /** Whether the page opens what is dragged: files anywhere, text outside of fields. @param {DragEvent} event */
  const accepts = ({ dataTransfer, target }) => {
    const types = dataTransfer?.types ?? [];
    if (types.includes("Files")) return true;
    return (
      !isInternalDrag &&
      types.includes("text/plain") &&
      !(target instanceof HTMLInputElement || target instanceof HTMLTextAreaElement)
    );
  };
  document.addEventListener("dragstart", () => {
    isInternalDrag = true;
  });
  document.addEventListener("dragend", () => {
    isInternalDrag = false;
  });
  document.addEventListener("dragover", (event) => {
    if (!accepts(event)) return;
    event.preventDefault();
    hint.hidden = false;
  });
  document.addEventListener("dragleave", (event) => {
    if (event.relatedTarget === null) hint.hidden = true;
  });
  document.addEventListener("drop", (event) => {
    hint.hidden = true;
    if (!accepts(event)) return;
    event.preventDefault();
    const files = [...(event.dataTransfer?.files ?? [])];
    const text = event.dataTransfer?.getData("text/plain") ?? "";
    open(files.length > 0 ? files : [new File([text], "the dropped text")]);
  });

  document.addEventListener("paste", (event) => {
    const { clipboardData, target } = event;
    const text = clipboardData?.getData("text/plain") ?? "";
    if (text === "" || target instanceof HTMLInputElement || target instanceof HTMLTextAreaElement) return;
    event.preventDefault();
    open([new File([text], "the pasted text")]);
  });

  /** @param {File[]} files */
  const open = (files) => attempt(async () => (await import("./open_file.js")).openFiles(page, files));

  /** @param {() => Promise<void>} work */
  async function attempt(work) {
    try {
      await work();
    } catch {
      page.dispatch({
        type: "notice",
        notice: {
          kind: "error",
          text: "The file was not opened: a part of the page could not be loaded. Check the network and try again.",
          location: null,
        },
      });
    }
  }
}
