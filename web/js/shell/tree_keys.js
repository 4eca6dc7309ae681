// Keys in the tree: up, down, Home, End, while single keys are off letters too; left and right fold; Space toggles the eye, Enter selects, Shift with left or right changes the opacity.

const typingMs = 700; // letters typed within this time belong together
let typed = { text: '', at: 0 };

export function treeKeys(event, ui) {
  const { key, target, currentTarget, timeStamp } = event;
  if (target.matches('input, select') || event.altKey || event.metaKey) return;
  const items = [...currentTarget.querySelectorAll('[role="treeitem"][data-key]')];
  const at = items.findIndex((item) => item.dataset.key === ui.row.value);
  const item = items[at];
  const go = (to) => {
    const next = items[Math.min(Math.max(to, 0), items.length - 1)];
    if (!next) return;
    ui.row.value = next.dataset.key;
    next.scrollIntoView({ block: 'nearest' });
  };
  const isSection = item?.hasAttribute('aria-expanded');
  const isOpen = item?.getAttribute('aria-expanded') === 'true';
  const send = (name, detail) => item?.dispatchEvent(new CustomEvent(name, { detail }));
  const step = (by) =>
    event.shiftKey
      ? send('row-step', { by, event })
      : by > 0
        ? isSection && (isOpen ? go(at + 1) : send('row-toggle', event))
        : isSection
          ? isOpen && send('row-toggle', event)
          : go(items.findLastIndex((other, n) => n < at && other.hasAttribute('aria-expanded')));
  const act = {
    ArrowDown: () => go(at + 1),
    ArrowUp: () => go(at - 1),
    Home: () => go(0),
    End: () => go(items.length - 1),
    ArrowRight: () => step(1),
    ArrowLeft: () => step(-1),
    ' ': () => send('row-toggle', event),
    Enter: () => (isSection ? send('row-toggle', event) : item?.click()),
  }[key];
  if (act) act();
  else if (ui.keys.areSinglesOff.value && key.length === 1 && !event.ctrlKey) find(key, timeStamp, items, at, go);
  else return;
  event.preventDefault();
  event.stopPropagation();
}

/** The next row whose name begins with what is being typed. */
function find(key, timeStamp, items, at, go) {
  const isMore = timeStamp - typed.at < typingMs;
  typed = { text: (isMore ? typed.text : '') + key.toLowerCase(), at: timeStamp };
  const order = items.map((_, n) => (at + n + (isMore ? 0 : 1) + items.length) % items.length);
  const found = order.find((n) => (items[n].getAttribute('aria-label') ?? items[n].textContent).toLowerCase().startsWith(typed.text));
  if (found !== undefined) go(found);
}
