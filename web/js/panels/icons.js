// The table of all icons: a 16 x 16 box, 1.5 px strokes in the colour of the text.
import { html, svg } from '../../lib/lit-html.js';

const paths = {
  logo: svg`<circle cx="8" cy="8" r="6.2"/><circle cx="8" cy="8" r="2.2"/><path d="M9.6 6.4 14 2"/>`,
  eye: svg`<path d="M1.5 8S4 3.8 8 3.8 14.5 8 14.5 8 12 12.2 8 12.2 1.5 8 1.5 8Z"/><circle cx="8" cy="8" r="2"/>`,
  eyeOff: svg`<path d="M6.3 4A6 6 0 0 1 8 3.800c4 0 6.5 4.2 6.5 4.200a11 11 0 0 1-1.7 2.100M4 5.200A10.5 10.5 0 0 0 1.5 8S4 12.2 8 12.200c1 0 1.9-.3 2.7-.6M2 2l12 12"/>`,
  crosshair: svg`<path d="M8 1.500v4.500M8 10v4.500M1.5 8H6M10 8h4.5"/>`,
  window: svg`<circle cx="8" cy="8" r="6"/><path d="M8 2a6 6 0 0 1 0 12Z" fill="currentColor"/>`,
  pan: svg`<path d="M8 1.500v13M1.5 8h13M6 3.500l2-2 2 2M6 12.500l2 2 2-2M3.5 6l-2 2 2 2M12.5 6l2 2-2 2"/>`,
  zoom: svg`<circle cx="7" cy="7" r="4.8"/><path d="m10.6 10.6 3.9 3.900M5 7h4M7 5v4"/>`,
  grid: svg`<rect x="2" y="2" width="12" height="12" rx="1"/><path d="M8 2v12M2 8h12"/>`,
  oneThree: svg`<rect x="2" y="2" width="12" height="12" rx="1"/><path d="M10 2v12M10 6h4M10 10h4"/>`,
  single: svg`<rect x="2" y="2" width="12" height="12" rx="1"/>`,
  undo: svg`<path d="M5.5 3 2.5 6l3 3M2.5 6H10a3.500 3.500 0 0 1 0 7H6"/>`,
  redo: svg`<path d="m10.5 3 3 3-3 3M13.5 6H6a3.500 3.500 0 0 0 0 7h4"/>`,
  reset: svg`<path d="M2.5 3v3.500H6M2.8 6.300A5.6 5.6 0 1 1 2.4 9"/>`,
  camera: svg`<path d="M1.8 5h2.700l1.2-1.800h4.600L11.5 5h2.700v8H1.800Z"/><circle cx="8" cy="8.7" r="2.3"/>`,
  maximise: svg`<path d="M9.5 2H14v4.500M6.5 14H2V9.500M14 2 9.3 6.700M2 14l4.7-4.7"/>`,
  restore: svg`<path d="M14 6.500H9.500V2M2 9.500h4.500V14M9.5 6.5 14 2M6.5 9.5 2 14"/>`,
  invite: svg`<path d="M6.5 9.5 9.5 6.500M7.3 4.700l1.6-1.600a2.9 2.9 0 0 1 4.1 4.100l-1.6 1.600M8.7 11.300l-1.6 1.600A2.9 2.9 0 0 1 3 8.800l1.6-1.6"/>`,
  help: svg`<circle cx="8" cy="8" r="6.2"/><path d="M6.2 6.200a1.9 1.9 0 1 1 2.6 1.900c-.5.2-.8.6-.8 1.200M8 11.500v.1"/>`,
  search: svg`<circle cx="7" cy="7" r="4.8"/><path d="m10.6 10.6 3.9 3.9"/>`,
  people: svg`<circle cx="6" cy="5" r="2.5"/><path d="M1.5 13.500c0-2.8 2-4.5 4.5-4.500s4.5 1.7 4.5 4.500M10.5 2.700a2.5 2.5 0 0 1 0 4.600M12 9.400c1.5.6 2.5 2 2.5 4.1"/>`,
  upload: svg`<path d="M8 11V2.500M4.5 5.500 8 2l3.5 3.500M2 10v3.500h12V10"/>`,
  trash: svg`<path d="M2.5 4.500h11M6 4.500V2.500h4v2M4 4.500l.7 9h6.600l.7-9M6.8 7v4M9.2 7v4"/>`,
  close: svg`<path d="m3.5 3.5 9 9M12.5 3.500l-9 9"/>`,
  check: svg`<path d="m2.5 8.5 3.5 3.5 7.5-8"/>`,
  warning: svg`<path d="M8 1.8 15 14H1ZM8 6v4M8 12v.1"/>`,
  error: svg`<path d="M5.2 1.500h5.600l3.7 3.700v5.600l-3.7 3.700H5.200l-3.7-3.700V5.200ZM5.8 5.800l4.4 4.400M10.2 5.800l-4.4 4.4"/>`,
  note: svg`<circle cx="8" cy="8" r="6.2"/><path d="M8 7.300v4M8 4.800v.1"/>`,
  image: svg`<rect x="1.8" y="2.5" width="12.4" height="11" rx="1.5"/><circle cx="5.5" cy="6" r="1.2"/><path d="m2 12 4-3.8 3 2.8 2-2 3 2.8"/>`,
  chevronDown: svg`<path d="m3.5 6 4.5 4.500L12.5 6"/>`,
  chevronLeft: svg`<path d="M10 3.5 5.5 8l4.5 4.5"/>`,
  chevronRight: svg`<path d="M6 3.5 10.5 8 6 12.5"/>`,
  tree: svg`<path d="M2 3h4M6 8h8M6 13h8M3.5 3v10H6M3.5 8H6"/>`,
  panel: svg`<rect x="2" y="2.5" width="12" height="11" rx="1"/><path d="M10 2.500v11"/>`,
  target: svg`<circle cx="8" cy="8" r="5"/><path d="M8 1v4M8 11v4M1 8h4M11 8h4"/>`,
  solo: svg`<circle cx="8" cy="8" r="6.2"/><circle cx="8" cy="8" r="2" fill="currentColor"/>`,
  circle: svg`<circle cx="8" cy="8" r="5.5"/>`,
  phase: svg`<circle cx="8" cy="8" r="5.5" stroke-opacity=".35"/><path d="M8 2.500A5.5 5.5 0 0 1 13.5 8"/>`,
  ready: svg`<circle cx="8" cy="8" r="5.8"/><circle cx="8" cy="8" r="2" fill="currentColor"/>`,
  // badges of fidelity, each with its own shape
  full: svg`<rect x="2.5" y="2.5" width="11" height="11" rx="2" fill="currentColor"/>`,
  live: svg`<circle cx="8" cy="8" r="6"/><circle cx="8" cy="8" r="2.5" fill="currentColor"/>`,
  reduced: svg`<circle cx="8" cy="8" r="6"/><path d="M2 8a6 6 0 0 0 12 0Z" fill="currentColor"/>`,
  stale: svg`<path d="M3.5 2h9M3.5 14h9M4.5 2c0 3.5 3.5 4 3.5 6s-3.5 2.5-3.5 6M11.5 2c0 3.5-3.5 4-3.5 6s3.5 2.5 3.5 6"/>`,
  disconnected: svg`<path d="M8 2.5 14.5 13.500h-13ZM1.5 2.500l13 12"/>`,
};

/** @param {keyof typeof paths} name @param {12|16|20} size */
export const icon = (name, size = 16) =>
  html`<svg class="icon" viewBox="0 0 16 16" width=${size} height=${size} aria-hidden="true">${paths[name]}</svg>`;
