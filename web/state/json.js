/** Scenarios as JSON text. Whole numbers above 2⁵³, such as times of segments, are BigInt. */

/** A whole number without decimal point and exponent. */
export const WHOLE = /^-?\d+$/;

// Called by JSON.stringify. A browser without rawJSON writes the nearest number.
Object.defineProperty(BigInt.prototype, "toJSON", {
  configurable: true,
  value() {
    return "rawJSON" in JSON ? /** @type {any} */ (JSON).rawJSON(String(this)) : Number(this);
  },
});

/** @param {string} text @returns {any} */
export function readJson(text) {
  const reviver = /** @type {(key: string, value: any, context?: {source?: string}) => any} */ (
    (_, value, context) =>
      typeof value === "number" &&
      Number.isInteger(value) &&
      !Number.isSafeInteger(value) &&
      WHOLE.test(context?.source ?? "")
        ? BigInt(context?.source ?? 0)
        : value
  );
  return JSON.parse(text, reviver);
}

/** A whole number as text, in the type that holds all of it. @param {string} digits */
export function whole(digits) {
  const number = Number(digits);
  return Number.isSafeInteger(number) ? number : BigInt(digits);
}
