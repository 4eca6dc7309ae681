// Splitters: what is dragged, or moved by arrow keys, to give tree, inspector, drawer and panes more room. Where they stand: room/splits.js.
import { html, nothing } from '../../lib/lit-html.js';
import { mount } from '../parts/mount.js';
import { say } from './later_words.js';
import { placeOf } from '../parts/page_look.js';

const stepPx = 16;
const stepShare = 0.02;
const names = {
  tree: say.splitTree,
  inspector: say.splitInspector,
  drawer: say.splitDrawer,
  columns: say.splitColumns,
  rows: say.splitRows,
};
const towards = { inspector: -1, drawer: -1 }; // these grow to the left and upwards
const hostOf = (name) => (['columns', 'rows'].includes(name) ? '.panes' : 'main');

/** @param {HTMLElement} host of the page @returns {() => void} takes them away */
export function placeSplitters(host, ui) {
  const stops = ['main', '.panes'].map((place) => {
    const element = Object.assign(document.createElement('div'), { className: 'splitters' });
    host.querySelector(place).append(element);
    const stop = mount(
      element,
      () => html`${ui.splitters.value.filter(({ name }) => hostOf(name) === place).map((one) => splitter(host, ui, one))}`,
    );
    return () => {
      stop();
      element.remove();
    };
  });
  return () => stops.forEach((stop) => stop());
}

const isShare = ({ name }) => name === 'columns' || name === 'rows';

function set(host, ui, one, value) {
  const high = one.name === 'drawer' ? Math.max(one.low, Math.floor(host.querySelector('main').clientHeight / 2)) : one.high;
  const next = Math.min(Math.max(value, one.low), high);
  ui.panes.splits.value = { ...ui.panes.splits.peek(), [one.key]: isShare(one) ? Math.round(next * 1000) / 1000 : Math.round(next) };
}

/** Back to where it stands without a person. */
function reset(ui, { key }) {
  const { [key]: _, ...others } = ui.panes.splits.peek();
  ui.panes.splits.value = others;
}

function splitter(host, ui, one) {
  const { name, isAcross, value, low, high } = one;
  const sign = towards[name] ?? 1;
  const now = () => ui.splitters.peek().find((other) => other.name === name);
  const onDown = (event) => {
    if (event.button) return;
    const { currentTarget, pointerId } = event;
    const panes = host.querySelector('.panes');
    const whole = isShare(one) ? (isAcross ? panes.clientHeight : panes.clientWidth) : 1;
    const along = (at) => placeOf(at)[isAcross ? 'y' : 'x'];
    const [from, start] = [along(event), now().value];
    currentTarget.setPointerCapture(pointerId);
    const abort = new AbortController();
    const on = (type, listener) => currentTarget.addEventListener(type, listener, { signal: abort.signal });
    on('pointermove', (move) => set(host, ui, now(), start + (sign * (along(move) - from)) / whole));
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) on(end, () => abort.abort());
    event.preventDefault();
    currentTarget.focus({ preventScroll: true });
  };
  const onKey = (event) => {
    const steps = { [isAcross ? 'ArrowDown' : 'ArrowRight']: 1, [isAcross ? 'ArrowUp' : 'ArrowLeft']: -1 }[event.key];
    const step = (isShare(one) ? stepShare : stepPx) * (event.shiftKey ? 4 : 1);
    if (steps) set(host, ui, now(), now().value + sign * steps * step);
    else if (event.key === 'Home' || event.key === 'End') set(host, ui, now(), event.key === 'Home' ? low : high);
    else if (event.key === 'Enter') reset(ui, one);
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  const number = (n) => (isShare(one) ? Math.round(n * 100) : Math.round(n));
  return html`<div class=${`splitter split-${name}`} role="separator" tabindex="0" aria-orientation=${isAcross ? 'horizontal' : 'vertical'}
    aria-label=${names[name]} aria-valuemin=${number(low)} aria-valuemax=${number(high)} aria-valuenow=${number(value)}
    aria-valuetext=${(isShare(one) ? say.splitShare : say.splitPx)({ n: number(value) })} title=${one.isChosen ? say.splitBack : nothing}
    @pointerdown=${onDown} @dblclick=${() => reset(ui, one)} @keydown=${onKey}></div>`;
}
