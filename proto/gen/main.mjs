// Generates code and pages from proto/*.json and the list of report codes: main.mjs FOLDER, which gets
//   scene.h scene.c      structs, enums, defaults, copy and compare of scene and view, without JSON, for core
//   wire_gen.h wire_gen.c  field tables and message structs for server/wire
//   rights_gen.h rights_gen.c  what each route needs
//   problem_gen.h problem_gen.c  types of problems
//   sentences_gen.h sentences_gen.c  sentences with their codes and places
//   gl_shaders.h gl_shaders.c  the shaders of core/render/gl/shaders
//   packets_gen.h packets_gen.c  structs, field tables and limits of the packets between daemon and renderer
//   openapi.json openapi.c  the HTTP API, as a file and for the daemon to serve
//   wire.js              the field tables for the page
//   undo_words.js        what a step of undo is called, for the page
//   volume_presets.h volume_presets.c volume_presets.js  transfer functions to begin with
//   dose_presets.h dose_presets.c dose_presets.js  weights by kind of tissue, isoeffective parameters, isodose levels
//   color_maps.h color_maps.c color_maps.js  tables of colour maps, and the stops of their gradients for the page
//   reference.html       all of it for people
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { checkedDocuments, checkedMessages } from './check.mjs';
import { sceneHeader, sceneSource } from './scene_c.mjs';
import { wireHeader, wireSource } from './wire_c.mjs';
import { wireScript } from './wire_js.mjs';
import { checkedColorMaps, colorMapsHeader, colorMapsScript, colorMapsSource } from './color_maps.mjs';
import { checkedDosePresets, dosePresetsHeader, dosePresetsScript, dosePresetsSource } from './dose_presets.mjs';
import { answerSchemas } from './answers.mjs';
import { openapi, openapiSource } from './openapi.mjs';
import { checkPackets, packetsHeader, packetsSource, questionRoutes } from './packets.mjs';
import { checkedPresets, presetsHeader, presetsScript, presetsSource } from './presets.mjs';
import { problemHeader, problemSource } from './problem_c.mjs';
import { readShaders, shadersHeader, shadersSource } from './shaders_c.mjs';
import { referencePage } from './reference.mjs';
import { reportCodes } from './report_codes.mjs';
import { checkedRights, rightsHeader, rightsSource, roomRoutes } from './rights.mjs';
import { sentencesHeader, sentencesSource } from './sentences.mjs';
import { undoWordsScript } from './undo_words.mjs';

const proto = join(dirname(fileURLToPath(import.meta.url)), '..');
const read = (name) => JSON.parse(readFileSync(join(proto, name), 'utf8'));
const scene = checkedDocuments(read('scene.json'));
const messages = checkedMessages(read('messages.json'));
const problems = read('problems.json');
const sentences = read('sentences.json');
const shaders = readShaders(join(proto, '../core/render/gl/shaders'));
const packets = read('packets.json');
checkPackets(packets, scene);
const http = read('http.json');
const routes = [...http.routes, ...questionRoutes(packets)];
const rights = checkedRights(read('rights.json'), routes, messages);
const api = openapi({ ...http, routes }, scene, answerSchemas(read('answers.json'), read('record.json'), scene, routes), messages, '1');
const presets = checkedPresets(read('volume_presets.json'), scene);
const dosePresets = checkedDosePresets(read('dose_presets.json'), scene);
const colorMaps = checkedColorMaps(read('color_maps.json'), scene);
const out = process.argv[2];
mkdirSync(out, { recursive: true });
const write = (name, text) => writeFileSync(join(out, name), text);

write('scene.h', sceneHeader(scene));
write('scene.c', sceneSource(scene));
write('wire_gen.h', wireHeader(scene, messages));
write('wire_gen.c', wireSource(scene, messages, roomRoutes(rights, messages)));
write('rights_gen.h', rightsHeader(rights));
write('rights_gen.c', rightsSource(rights));
write('packets_gen.h', packetsHeader(packets));
write('packets_gen.c', packetsSource(packets));
write('problem_gen.h', problemHeader(problems));
write('problem_gen.c', problemSource(problems));
write('sentences_gen.h', sentencesHeader(sentences));
write('sentences_gen.c', sentencesSource(sentences));
write('gl_shaders.h', shadersHeader(shaders));
write('gl_shaders.c', shadersSource(shaders));
write('volume_presets.h', presetsHeader());
write('volume_presets.c', presetsSource(presets));
write('volume_presets.js', presetsScript(presets));
write('dose_presets.h', dosePresetsHeader());
write('dose_presets.c', dosePresetsSource(dosePresets));
write('dose_presets.js', dosePresetsScript(dosePresets));
write('color_maps.h', colorMapsHeader());
write('color_maps.c', colorMapsSource(colorMaps));
write('color_maps.js', colorMapsScript(colorMaps));
write('wire.js', wireScript(scene, messages));
write('undo_words.js', undoWordsScript(scene));
write(
  'reference.html',
  referencePage(
    scene,
    messages,
    packets,
    problems,
    reportCodes(readFileSync(join(proto, '../core/report/report_codes.h'), 'utf8')),
    sentences,
    rights,
  ),
);
write('openapi.json', JSON.stringify(api, null, 1));
write('openapi.c', openapiSource(api));
