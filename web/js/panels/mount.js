// Draws a template into an element, and again whenever a signal it read has changed.
import { nothing, render } from '../../lib/lit-html.js';
import { Directive, directive } from '../../lib/directive.js';
import { effect } from '../../lib/signals-core.js';

/** @param {HTMLElement} host @param {() => unknown} draw @returns {() => void} stops and empties */
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

  // Through the object model, not a style attribute, which the content security policy forbids.
  update({ element }, [values]) {
    for (const [name, value] of Object.entries(values)) element.style.setProperty(name, value);
    return this.render();
  }
}

/** Sets CSS properties of the element it stands in: html`<i ${variables({ '--fill': '40%' })}>`. */
export const variables = directive(Variables);
