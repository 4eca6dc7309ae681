// The red strip of a server that is open to everybody, above every page and on paper.
import { html, render } from '../../../lib/lit-html.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

export function openStrip() {
  if (document.querySelector('.open-strip')) return;
  const strip = document.createElement('aside');
  strip.className = 'open-strip';
  strip.setAttribute('aria-label', say.openDoor);
  render(html`${icon('warning')}<p><b>${say.openDoor}</b> ${say.openDoorIs}</p>`, strip);
  document.body.prepend(strip);
  document.body.classList.add('open-to-everybody');
}
