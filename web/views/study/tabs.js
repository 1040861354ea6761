/** The tabs of the study, which load when it is first opened. */
import { createCompare } from "./compare.js";
import { createMeasures } from "./measures.js";
import { createMotorTab } from "./motor.js";
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
  motor: createMotorTab,
};
