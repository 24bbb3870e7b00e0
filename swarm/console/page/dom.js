// Elements made from words. Whatever a log or a message says becomes text, never markup.

/** An element with attributes and children: texts, numbers, elements. */
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (key in made && typeof value !== "string") made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children.filter((child) => child !== null).map((child) => (child instanceof Node ? child : String(child))));
  return made;
}

export const byId = (id) => document.getElementById(id);

/** Set a text only if it is another one: screen readers and layout are left alone. */
export function say(id, text) {
  const where = byId(id);
  if (where.textContent !== text) where.textContent = text;
}
