/** Parts of the form that few experiments use, loaded on demand. */
import { controllerPart } from "./controller_part.js";
import { LISTS } from "./lists.js";
import { groupItems } from "./motion_groups.js";
import { motorFields } from "./motor_fields.js";
import { plantFields } from "./plant_fields.js";
import { segmentRows, sendRows } from "./source_rows.js";

export const ADDITIONAL_PARTS = {
  controllerPart,
  groupItems,
  lists: LISTS,
  motorFields,
  plantFields,
  segmentRows,
  sendRows,
};
