// The grip of the dose legend: a drag has it right of the panes or above them, arrow keys do the same, a click opens its settings.
import { signal } from '../../../lib/signals-core.js';
import { legendPlace } from './legend_place.js';

const slackPx = 6; // a shorter drag is a click
const sidePx = 200; // at the right edge of the panes

export class LegendGrip {
  #ui;
  #place;
  #from = null; // where the pointer was taken
  #isDragged = false;
  /** 'to-column' or 'to-strip' while a drag would change where it stands; else '' */
  towards = signal('');

  constructor(world) {
    this.#ui = world.ui;
    this.#place = legendPlace(world);
  }

  down = (event) => {
    if (event.button > 0) return;
    this.#from = [event.clientX, event.clientY];
    this.#isDragged = false;
    event.currentTarget.setPointerCapture(event.pointerId);
  };

  move = (event) => {
    if (!this.#from) return;
    const away = Math.hypot(event.clientX - this.#from[0], event.clientY - this.#from[1]);
    this.#isDragged ||= away > slackPx;
    if (this.#isDragged) this.towards.value = this.#towards(event);
  };

  up = (event) => {
    if (!this.#from) return;
    const towards = this.#isDragged ? this.#towards(event) : '';
    this.cancel();
    if (towards) this.#place.set({ stands: towards === 'to-column' ? 'column' : 'strip' });
  };

  cancel = () => {
    this.#from = null;
    this.towards.value = '';
  };

  click = () => {
    if (!this.#isDragged) this.#ui.choose('legend');
    this.#isDragged = false;
  };

  key = (event) => {
    const stands = { ArrowRight: 'column', ArrowUp: 'strip', ArrowLeft: 'strip' }[event.key];
    if (!stands || !this.#place.isOffered) return;
    event.preventDefault();
    this.#place.set({ stands });
  };

  #towards({ clientX, clientY, currentTarget }) {
    if (!this.#place.isOffered) return '';
    const { right, top } = currentTarget.closest('main').getBoundingClientRect();
    const isRight = clientX > right - sidePx && clientY > top + sidePx / 4;
    if (this.#place.isColumn) return isRight ? '' : 'to-strip';
    return isRight ? 'to-column' : '';
  }
}
