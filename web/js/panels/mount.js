// Draws a template into an element, and draws it again whenever a signal that it read changes.
import { nothing, render } from '../../lib/lit-html.js';
import { Directive, directive } from '../../lib/directive.js';
import { effect } from '../../lib/signals-core.js';

/** @param {HTMLElement} host @param {() => unknown} draw @returns {() => void} stops, and empties the element */
export function mount(host, draw) {
  const stop = effect(() => {
    render(draw(), host);
  });
  return () => {
    stop();
    render(nothing, host);
  };
}

class Variables extends Directive {
  render() {
    return nothing;
  }

  // By the object model: the content security policy forbids style attributes.
  update({ element }, [values]) {
    for (const [name, value] of Object.entries(values)) element.style.setProperty(name, value);
    return this.render();
  }
}

/** Sets CSS properties of its element: html`<i ${variables({ '--fill': '40%' })}>`. */
export const variables = directive(Variables);
