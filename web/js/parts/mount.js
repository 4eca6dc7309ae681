// Draws a template into an element, and draws it again whenever a signal that it read changes.
import { nothing, render } from '../../lib/lit-html.js';
import { Directive, directive } from '../../lib/directive.js';
import { effect, signal } from '../../lib/signals-core.js';

/** @param {HTMLElement} host @param {() => unknown} draw @param {import('./redraw.js').Redraw|null} redraw may put drawing it again off
 *  @returns {() => void} stops, and empties the element */
export function mount(host, draw, redraw = null) {
  const tick = signal(0);
  let [isDrawn, isWaiting] = [false, false];
  const stop = effect(() => {
    isWaiting = isDrawn && !isWaiting && (redraw?.puts(host, tick) ?? false);
    if (isWaiting) return void tick.value; // nothing else wakes this effect until then
    isDrawn = true;
    render(draw(), host);
  });
  return () => {
    stop();
    render(nothing, host);
  };
}

class Variables extends Directive {
  #last = {};

  render() {
    return nothing;
  }

  // Sets styles by the object model: the content security policy forbids style attributes.
  update({ element }, [values]) {
    for (const [name, value] of Object.entries(values)) {
      if (this.#last[name] === value) continue; // set again, even the same value would have the browser compute styles
      this.#last[name] = value;
      element.style.setProperty(name, value);
    }
    return this.render();
  }
}

/** Sets CSS properties of its element: html`<i ${variables({ '--fill': '40%' })}>`. */
export const variables = directive(Variables);
