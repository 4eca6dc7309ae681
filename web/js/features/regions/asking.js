// When the server is asked about regions: the figures of the chosen one, which cannot be drawn.
import { computed, effect } from '../../../lib/signals-core.js';
import { Answer } from '../../parts/answer.js';
import { inQuestion } from './refusals.js';
import { shapeQuery } from './shapes.js';

/** The figures of the chosen region's shape: asked for when another region or another shape is chosen. */
export function liveShape({ room, ui, api, clock }) {
  const key = () => {
    const scene = room.scene.value;
    const region = room.plan.value?.regions.find((other) => other.id === ui.region.value);
    const representation = region && scene?.regions[region.id]?.representation;
    const isReady = room.renderer.value.state === 'ready' && Boolean(representation) && region.voxels > 0;
    return isReady ? JSON.stringify([region.id, representation, shapeQuery(scene, representation)]) : '';
  };
  const ask = (wanted, aborted) => {
    const [region, , query] = JSON.parse(wanted);
    return api.surface(room.planId.peek(), region, query, aborted);
  };
  return new Answer({ key, ask, clock, restMs: 0, renews: true });
}

/** That answer with what it is of: {region, representation, result, error}; blank while a newer one is still to come. */
export function shapeNow(answer) {
  const { result, error, isOld } = answer.state.value;
  if (isOld || !answer.of) return { region: '', representation: '', result: null, error: '' };
  const [region, representation] = JSON.parse(answer.of);
  return { region, representation, result, error };
}

/** Finds the regions that cannot be drawn whenever other regions are shown, or in another way. */
export function askRefusals({ room, refusals }) {
  const questions = computed(() =>
    room.renderer.value.state === 'ready' ? JSON.stringify(inQuestion(room.plan.value, room.scene.value)) : '',
  );
  const stop = effect(() => {
    if (questions.value) refusals.ask(room.planId.peek(), JSON.parse(questions.value));
  });
  return () => {
    stop();
    refusals.stop();
  };
}
