/**
 * Keyboard commands. Each part of the page registers its own; the help lists all. Single letters only work while the
 * part has the focus.
 */

/**
 * @typedef {object} Command
 * @property {string[]} keys  Such as `n`, `Shift+ArrowLeft`, `Ctrl+Z`; Ctrl includes the command key of a Mac.
 * @property {string} text    Its effect, for the help.
 * @property {(event: KeyboardEvent) => void | false} run  `false` leaves the key to the browser.
 *
 * @typedef {{title: string, commands: Command[]}} Scope  A part of the page.
 */

/** @type {Scope[]} */
const scopes = [];

/**
 * Registers the keys of a part of the page.
 * @param {HTMLElement | Document} target  They work while the focus is in it.
 * @param {string} title  Name of the part in the help; parts with the same name are listed once.
 * @param {Command[]} commands
 */
export function registerCommands(target, title, commands) {
  if (!scopes.some((scope) => scope.title === title)) scopes.push({ title, commands });
  const byKey = new Map(commands.flatMap((command) => command.keys.map((key) => [key.toLowerCase(), command])));
  target.addEventListener("keydown", (raw) => {
    const event = /** @type {KeyboardEvent} */ (raw);
    if (event.defaultPrevented || event.isComposing) return;
    const command = byKey.get(nameOf(event).toLowerCase()) ?? byKey.get(digitOf(event));
    if (command && command.run(event) !== false) event.preventDefault();
  });
}

/** All registered commands by part. */
export function listed() {
  return scopes;
}

/** A key with its modifiers in the form of `Command.keys`. A character that needs Shift, such as `?`, has no `Shift+`. @param {KeyboardEvent} event */
function nameOf({ key, ctrlKey, metaKey, altKey, shiftKey }) {
  const isSymbol = key.length === 1 && !/[a-z]/i.test(key);
  return [
    ctrlKey || metaKey ? "Ctrl+" : "",
    altKey ? "Alt+" : "",
    shiftKey && !isSymbol ? "Shift+" : "",
    key === " " ? "Space" : key,
  ].join("");
}

/** A digit by the position of its key: on many keyboards Shift and a digit types a symbol, or only Shift types a digit. @param {KeyboardEvent} event */
function digitOf({ code, ctrlKey, metaKey, altKey, shiftKey }) {
  const [, digit] = /^Digit(\d)$/.exec(code) ?? [];
  return digit && !ctrlKey && !metaKey && !altKey ? `${shiftKey ? "shift+" : ""}${digit}` : "";
}
