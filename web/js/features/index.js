// The features of the page: the only list. To add one, add a folder with a feature.js, and a row here and in the array. Shell and panes know features by
// this table alone; parts of a page, a menu or a pane that several features have stand in its order.
import { beams } from './beams/feature.js';
import { bookmarks } from './bookmarks/feature.js';
import { clip } from './clip/feature.js';
import { dose } from './dose/feature.js';
import { fits } from './fits/feature.js';
import { image } from './image/feature.js';
import { measures } from './measures/feature.js';
import { meeting } from './meeting/feature.js';
import { notes } from './notes/feature.js';
import { patient } from './patient/feature.js';
import { planes } from './planes/feature.js';
import { pointers } from './pointers/feature.js';
import { record } from './record/feature.js';
import { regions } from './regions/feature.js';
import { report } from './report/feature.js';
import { tracks } from './tracks/feature.js';

/**
 * All of it is optional. world is that of shell/room_page.js.
 * @typedef {object} Feature
 * @property {(world) => void} [make] puts into world what it keeps of a room, before the panes are made
 * @property {(world) => (() => void)} [start] begins what goes on while the room is open; returns what ends it
 * @property {Section[]} [sections] of the tree
 * @property {Record<string, string>} [kinds] kinds of selection, each with the section that has its rows, or ''
 * @property {Lazy} [blocks] exports blocks: {kind: (world, isDisabled, change) => template}, what Selection shows of each kind
 * @property {boolean} [isSoon] blocks are loaded before the first click
 * @property {(world) => unknown} [aboveBlock] in Selection above the block of any kind
 * @property {Tab[]} [tabs] of the inspector
 * @property {Record<string, (world, at: number, event: KeyboardEvent) => void>} [keys] commands of the active pane, by their name in room/commands.js
 * @property {(world, event: KeyboardEvent, at: number) => (() => void)|null} [key] what another key does there
 * @property {(world) => unknown} [bar] above the panes @property {(world) => unknown} [legend] below the bars, or at the right of the panes
 * @property {{has: (plan) => boolean, draw: (world) => unknown}} [drawer] beside the panes
 * @property {(world) => unknown} [dialog] over the page @property {string[]} [dialogs] the popovers that it shows as dialogs
 * @property {{mode, show, meet, end}} [strip] buttons: (world, size or isDock) => template. mode: tools of the left button, show: what pictures show,
 *   meet: what is for the others in the room, end: what acts on the active pane
 * @property {string[]} [lateTools] values of ui.tool whose handlers are added by addTool of pane/pane_tools.js once they are loaded
 * @property {(world, act) => unknown} [panesMenu] at the end of the menu of the panes
 * @property {(world) => ({name, place, menu}|null)} [bannerPlan] the name of the shown plan, where it is not the folder's
 * @property {(world) => unknown} [bannerStart] @property {(world) => unknown} [bannerName] below the plan's name @property {(world) => unknown} [bannerFacts]
 * @property {(world) => unknown} [chip] in the room chip before its words @property {(world) => unknown} [chipCard] at the top of its card
 * @property {(world) => unknown} [planTop] in the inspector's Plan above the parts @property {(world) => unknown} [planParts] below them
 * @property {(world) => unknown} [probeTool] in the head of Probe @property {(world) => unknown} [probe] below it
 * @property {(world) => string} [here] words on the crosshair's place
 * @property {(pane: object, view) => PanePart} [pane] made for each pane; pane: world with host, place(), box() and pointAt(x, y) of the pane
 * @property {{has: (kind) => boolean, isLocked: (kind) => boolean, code: Lazy}} [panesOf] code exports makePane(pane), the handler of panes of these kinds
 *   (pane/pane_tools.js); isLocked: nothing else moves their camera
 *
 * A PanePart may have the methods of a PaneHandler but draw, is asked after the tool and the pane's kind, and may draw:
 * @typedef {object} PanePart
 * @property {(place) => unknown} [layer] SVG below the crosshair; place {scene, plane: null in 3-D, tolerance, header, box, pane}
 * @property {() => {lines, handles}} [lines] below and above the letters @property {(place: () => object) => unknown} [pins]
 * @property {() => unknown} [head] behind the pane's place in its header
 *
 * @typedef {object} Section
 * @property {string} id @property {string} name @property {string} icon @property {number} place among the sections
 * @property {(plan, scene) => unknown} has a section without rows is not shown @property {(world) => string} note @property {(world) => unknown} rows
 * @property {(world) => unknown} [tools] above the rows
 *
 * @typedef {object} Tab
 * @property {string} id @property {string} name @property {(world) => unknown} draw @property {(world) => number} [count] behind the name
 * @property {(plan) => boolean} [inSheet] told of a plan: this tab stands in the sheet alone, behind Probe
 */

/** @type {Feature[]} */
export const features = [
  fits,
  patient,
  image,
  measures,
  dose,
  tracks,
  planes,
  regions,
  beams,
  clip,
  bookmarks,
  notes,
  record,
  meeting,
  pointers,
  report,
];

/** The results of one part of the features, undefined for those without it. */
export const partsOf = (name, ...args) => features.map((feature) => feature[name]?.(...args));
