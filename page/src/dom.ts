// The few things done to the document, changed only where they differ: text that stays costs no layout.

/** The element of index.html with this id; a missing one is a mistake of ours. */
export function byId<T extends Element = HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (!element) throw new Error(`index.html has no #${id}`);
  return element as unknown as T;
}

export function setText(element: Element, words: string): void {
  if (element.textContent !== words) element.textContent = words;
}

export function setClass(element: Element, name: string): void {
  if (element.getAttribute('class') !== name) element.setAttribute('class', name);
}

/** A new element with class and text or children. */
export function make(tag: string, name = '', ...content: (string | Node)[]): HTMLElement {
  const element = document.createElement(tag);
  if (name) element.className = name;
  element.append(...content);
  return element;
}

/** Fills a table's body; cells that begin with `!` deserve a look and are marked so. */
export function fillRows(body: HTMLElement, rows: string[][]): void {
  while (body.children.length > rows.length) body.lastElementChild?.remove();
  rows.forEach((cells, i) => {
    let row = body.children[i];
    if (!row || row.children.length !== cells.length) {
      const fresh = make('tr', '', ...cells.map((_, k) => make(k ? 'td' : 'th')));
      fresh.firstElementChild?.setAttribute('scope', 'row');
      if (row) row.replaceWith(fresh);
      else body.append(fresh);
      row = fresh;
    }
    cells.forEach((cell, k) => {
      const at = row.children[k] as HTMLElement;
      const marked = cell.startsWith('!');
      setText(at, marked ? `⚠\u00a0${cell.slice(1)}` : cell);
      setClass(at, marked ? 'marked' : '');
    });
  });
}
