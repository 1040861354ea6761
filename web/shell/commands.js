/**
 * Keyboard commands. Each part of the page registers its own; the help lists all. Single letters only work while the
 * part has the focus.
 */

/**
 * @typedef {object} Command
 * @property {string[]} keys  Such as `n`, `Shift+ArrowLeft`, `Ctrl+Z`; Ctrl is the command key of a Mac, too.
 * @property {string} text    What it does, as the help says it.
 * @property {(event: KeyboardEvent) => void | false} run  `false` leaves the key to the browser.
 *
 * @typedef {{title: string, commands: Command[]}} Scope  A part of the page.
 */

/** @type {Scope[]} */
const scopes = [];

/**
 * Hears a part's keys.
 * @param {HTMLElement | Document} target  Has the focus in it when they count.
 * @param {string} title  What the part is called in the help; parts of one title are listed once.
 * @param {Command[]} commands
 */
export function listen(target, title, commands) {
  if (!scopes.some((scope) => scope.title === title)) scopes.push({ title, commands });
  const byKey = new Map(commands.flatMap((command) => command.keys.map((key) => [key.toLowerCase(), command])));
  target.addEventListener("keydown", (raw) => {
    const event = /** @type {KeyboardEvent} */ (raw);
    if (event.defaultPrevented || event.isComposing) return;
    const command = byKey.get(nameOf(event).toLowerCase()) ?? byKey.get(digitOf(event));
    if (command && command.run(event) !== false) event.preventDefault();
  });
}

/** All commands so far, by the parts that they belong to. */
export function listed() {
  return scopes;
}

/** A key with its modifiers, as `Command.keys` writes it. Of a sign that needs Shift, Shift is no part. @param {KeyboardEvent} event */
function nameOf({ key, ctrlKey, metaKey, altKey, shiftKey }) {
  const sign = key.length === 1 && !/[a-z]/i.test(key);
  return [
    ctrlKey || metaKey ? "Ctrl+" : "",
    altKey ? "Alt+" : "",
    shiftKey && !sign ? "Shift+" : "",
    key === " " ? "Space" : key,
  ].join("");
}

/** A key of the row of digits by its place, for on many keyboards Shift makes another sign of it, or only Shift a digit. @param {KeyboardEvent} event */
function digitOf({ code, ctrlKey, metaKey, altKey, shiftKey }) {
  const [, digit] = /^Digit(\d)$/.exec(code) ?? [];
  return digit && !ctrlKey && !metaKey && !altKey ? `${shiftKey ? "shift+" : ""}${digit}` : "";
}
