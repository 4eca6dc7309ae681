// Words of measures: names, values with their units.
import { shortId } from '../../room/marks.js';
import { kinds, pointsOf, valueOf } from './measures.js';
import { shownImage } from '../../room/plan.js';
import { number, significant, unitText } from '../../parts/format.js';
import { say } from './drawn_words.js';

export const kindIcons = { distance: 'measure', angle: 'angle', polyline: 'polyline', ellipse: 'ellipse' };
export { kinds };

const numbered = { distance: say.distanceNumber, angle: say.angleNumber, polyline: say.polylineNumber, ellipse: say.ellipseNumber };
export const measureName = (id, { name, kind }) => name || numbered[kind]({ n: shortId(id, /^(m|own)/) });

/** The image that an ellipse is measured in. */
export const imageOf = (plan, scene, measure) => plan.images.find(({ id }) => id === measure.image) ?? shownImage(plan, scene);

/** "38 ± 12 HU"; '…' until it is known, '' where there is no image. */
function meanText(world, id, measure) {
  const { room, ellipses } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const image = plan && imageOf(plan, scene, measure);
  if (!image || measure.points.length < 3) return '';
  const { statistics, isOld } = ellipses.of(id, room.planId.value, image.id, pointsOf(measure));
  if (!statistics) return isOld ? '…' : '';
  if (!statistics.n) return say.outside;
  const words = `${significant(statistics.mean)} ± ${significant(statistics.sd)}${image.unit ? ` ${unitText(image.unit)}` : ''}`;
  return `${plan.images.length > 1 ? `${image.modality} ` : ''}${words}${isOld ? ' …' : ''}`;
}

/** "12.3 mm", "45.0°", and of an ellipse its area and the image's mean with standard deviation in it: one string each. @returns {string[]} */
export function valueTexts(world, id, measure) {
  const value = valueOf(measure);
  if (value === null) return [];
  if (measure.kind === 'angle') return [Number.isFinite(value) ? `${number(value, 1)}°` : '–'];
  if (measure.kind !== 'ellipse') return [`${number(value, 1)} mm`];
  return [`${number(value / 100, 2)} cm²`, id ? meanText(world, id, measure) : ''].filter(Boolean);
}

export const valueText = (world, id, measure) => valueTexts(world, id, measure).join(', ');
