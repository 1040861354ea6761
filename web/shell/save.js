/** Saves files through the downloads of the browser. */

/**
 * @param {string} name  File name with its ending.
 * @param {string} type  MIME type.
 * @param {BlobPart[]} parts
 */
export function save(name, type, parts) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob(parts, { type }));
  link.download = name;
  link.click();
  // The browser reads the file after this task; a minute is enough.
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
