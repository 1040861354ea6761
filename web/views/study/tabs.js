/** The tabs of the study and their style sheet, which load when it is first opened. */
import { element } from "../../dom.js";
import { createCompare } from "./compare.js";
import { createMeasures } from "./measures.js";
import { createSine } from "./sine.js";
import { createTables } from "./tables.js";
import { createTorque } from "./torque.js";

/** @type {{[name in import("../../state/types.js").StudyName]: (page: import("./study.js").StudyPage) => import("./study.js").StudyTab}} */
export const TABS = {
  compare: createCompare,
  measures: createMeasures,
  tables: createTables,
  sine: createSine,
  torque: createTorque,
};

/** Puts the style sheet into the page; done when it holds. */
export function dress() {
  const sheet = /** @type {HTMLLinkElement} */ (
    element("link", { rel: "stylesheet", href: new URL("../../style/study.css", import.meta.url).href })
  );
  return new Promise((resolve, reject) => {
    sheet.addEventListener("load", resolve);
    sheet.addEventListener("error", reject);
    document.head.append(sheet);
  });
}
