// The words of what lies under a place: of the card at the pointer, and of the caption of a pane.
import { imageValue, number, position, significant, unitText, volume } from '../parts/format.js';
import { shownImage } from '../room/plan.js';
import { say } from './words.js';

/** The words of the card: the innermost region first. */
export function words({ regions: ids, images, point_lps_mm: point, onSurface, dose }, plan, scene) {
  const regions = ids.map((id) => plan.regions.find((region) => region.id === id)).filter(Boolean);
  const [first, ...outer] = regions;
  const image = shownImage(plan, scene);
  const found = image && images?.find(({ id }) => id === image.id);
  return {
    name: first?.name ?? (plan.regions.length ? say.outside : (image?.modality ?? '')),
    isOutside: !first,
    color: first && (scene.regions[first.id]?.color ?? first.color),
    value: found && found.value !== null ? { label: image.modality, ...imageValue(found.value, image.unit) } : null,
    lines: [
      doseLine(dose),
      outer.length ? say.in({ regions: outer.map((region) => region.name).join(', ') }) : '',
      first && scene.regions[first.id]?.visible === false ? say.hidden : '',
      onSurface && first?.voxels ? volume(first.volume_cm3) : '',
      position(point),
    ].filter(Boolean),
  };
}

/** "4.82 Gy(w), 78.6 %"; '' where the dose is not shown or has no value. */
const doseLine = (answer) =>
  Number.isFinite(answer?.value)
    ? [`${significant(answer.value)} ${unitText(answer.unit)}`, Number.isFinite(answer.percent) ? `${number(answer.percent, 1)} %` : '']
        .filter(Boolean)
        .join(', ')
    : '';

/** Words of the values at the crosshair for a caption. */
export function spoken(result, plan, scene) {
  if (!plan || !scene) return [];
  const { name, isOutside, value } = words(result, plan, scene);
  return [
    plan.regions.length ? (isOutside ? say.outsideWithin : name) : '',
    value ? `${value.label} ${value.text} ${value.unit}`.trim() : '',
  ];
}
