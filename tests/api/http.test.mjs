// The HTTP API against the real daemon.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { call, demo, openPlan, startDaemon, until } from './daemon.mjs';
import { centreOf, readPng } from './png.mjs';
import { parseStrict } from './strict_json.mjs';

let daemon, url, api, plan, broken;

before(async () => {
  broken = mkdtempSync(join(tmpdir(), 'beamroom-plans-'));
  mkdirSync(join(broken, 'broken'));
  writeFileSync(
    join(broken, 'broken', 'plan.json'),
    '{"format":"beamroom-plan","version":1,"images":[{"id":"ct","path":"../../etc/passwd"}]}',
  );
  mkdirSync(join(broken, 'letters'));
  writeFileSync(join(broken, 'letters', 'letter.txt'), 'no plan');
  daemon = await startDaemon({ plans: [demo, broken] });
  url = daemon.url;
  api = `${url}/api/v1`;
  plan = `${api}/plans/phantom`;
  await until(
    async () => (await call(`${api}/plans`)).json.plans,
    (plans) => plans.length === 3 && plans.every((p) => p.parts.length || p.reason),
  );
});
after(async () => {
  await daemon?.stop();
  rmSync(broken, { recursive: true, force: true });
});

function assertProblem(answer, status, type, pointer) {
  assert.equal(answer.status, status, answer.text);
  assert.equal(answer.type, 'application/problem+json');
  assert.equal(answer.json.type, `/problems/${type}`);
  assert.equal(answer.json.status, status);
  assert.ok(answer.json.detail.length > 5);
  if (pointer !== undefined) assert.equal(answer.json.pointer, pointer);
}

describe('the server', () => {
  test('says that it is alive, what draws, and what it is', async () => {
    assert.equal((await call(`${url}/healthz`)).text, 'ok\n');
    const ready = await until(
      () => call(`${url}/readyz`),
      (a) => a.status === 200,
    );
    assert.equal(ready.status, 200, ready.text);
    assert.match(ready.json.gl.back_end, /^(egl-device|egl-surfaceless|osmesa|soft)$/);
    const version = await call(`${api}/version`);
    assert.equal(version.json.api, 1);
    assert.equal(version.json.gl.back_end, ready.json.gl.back_end);
  });

  test('serves the page with a policy that lets it run only its own scripts', async () => {
    const page = await call(`${url}/`);
    assert.equal(page.status, 200);
    assert.match(page.type, /^text\/html/);
    assert.match(page.headers.get('content-security-policy'), /default-src 'self'/);
    assert.equal(page.headers.get('x-content-type-options'), 'nosniff');
    const again = await call(`${url}/`, 'GET', undefined, { 'If-None-Match': page.headers.get('etag') });
    assert.equal(again.status, 304);
  });

  test('keeps to its folder whatever the address says', async () => {
    for (const path of ['/../Makefile', '/%2e%2e/Makefile', '/js/..%2f..%2fMakefile', '/.stamp', '//etc/passwd'])
      assertProblem(await call(url + path), 404, 'not-found');
  });

  test('answers an unknown address, a wrong method and another origin with a problem', async () => {
    assertProblem(await call(`${api}/nothing`), 404, 'not-found');
    const wrong = await call(`${api}/plans`, 'DELETE');
    assertProblem(wrong, 405, 'method');
    assert.equal(wrong.headers.get('allow'), 'GET, POST');
    assertProblem(await call(`${api}/rooms`, 'POST', { plan: 'phantom' }, { Origin: 'https://elsewhere.example' }), 403, 'forbidden');
    assertProblem(await call(`${api}/plans/${'x'.repeat(64)}`), 404, 'not-found');
    assertProblem(await call(`${api}/plans/UPPER`), 404, 'not-found');
  });

  test('counts for Prometheus without naming a plan', async () => {
    const metrics = await call(`${url}/metrics`);
    assert.match(metrics.type, /^text\/plain/);
    assert.match(metrics.text, /^beamroom_http_requests_total\{code="2xx"\} [1-9]/m);
    assert.match(metrics.text, /^beamroom_plans\{state="unreadable"\} 2$/m);
    assert.doesNotMatch(metrics.text, /phantom/);
    for (const line of metrics.text.trim().split('\n'))
      assert.match(line, /^(# (HELP|TYPE) beamroom_\w+ .+|beamroom_\w+(\{[^}]*\})? -?[\d.e+-]+)$/);
  });

  test('describes every address it has, and has every address it describes', async () => {
    const description = (await call(`${api}/openapi.json`)).json;
    assert.equal(description.openapi, '3.1.0');
    // /plans/search is also an address of /plans/{plan}, for the methods that it does not have itself
    const isOfAnother = (address, method) =>
      Object.entries(description.paths).some(
        ([path, operations]) =>
          path !== address && operations[method] && new RegExp(`^${path.replace(/\{\w+\}/g, '[^/]+')}$`).test(address),
      );
    for (const [path, operations] of Object.entries(description.paths)) {
      const address = url + path.replace(/\{\w+\}/g, 'no-such-thing');
      for (const method of ['get', 'post', 'patch', 'delete', 'put']) {
        const answer = await call(address, method.toUpperCase(), ['post', 'patch', 'put'].includes(method) ? {} : undefined);
        if (operations[method]) {
          assert.notEqual(answer.status, 405, `${method} ${path}`);
          assert.doesNotMatch(answer.json?.detail ?? '', /^nothing is at/, `${method} ${path}`);
        } else if (!isOfAnother(path, method)) assertProblem(answer, 405, 'method');
      }
    }
  });

  test('refuses a WebSocket of a room that is not there on a connection that has been used, and closes it', async () => {
    const { hostname, port } = new URL(url);
    const socket = connect(Number(port), hostname);
    let got = '';
    const closed = new Promise((done) => socket.on('close', done));
    socket.on('data', (bytes) => {
      got += bytes;
      if (/\r\n\r\nok\n$/.test(got))
        socket.write(
          'GET /api/v1/rooms/x/ws HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n',
        );
    });
    socket.write('GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n');
    await closed;
    assert.match(got, /HTTP\/1\.1 404 /);
    assert.match(got, /connection: close/i);
  });
});

describe('a plan', () => {
  test('is listed with its parts, one that cannot be read with the reason', async () => {
    const { plans } = (await call(`${api}/plans`)).json;
    const phantom = plans.find((p) => p.id === 'phantom');
    assert.equal(phantom.is_phantom, true);
    assert.ok(phantom.parts.includes('CT'), phantom.parts.join());
    const broken = plans.find((p) => p.id === 'broken');
    assert.equal(broken.state, 'unreadable');
    assert.match(broken.reason, /passwd|\.\./);
    assert.equal(broken.has_plan_file, true);
    const letters = plans.find((p) => p.id === 'letters');
    assert.deepEqual([letters.state, letters.has_plan_file], ['unreadable', false]);
    assertProblem(await call(`${api}/plans/broken/open`, 'POST'), 409, 'plan-unreadable');
    assertProblem(await call(`${api}/plans/nowhere/open`, 'POST'), 404, 'not-found');
  });

  test('is not loaded for a picture of loaded plans only', async () => {
    const body = { view: { size_px: [64, 48] }, only_loaded: true };
    assertProblem(await call(`${plan}/render`, 'POST', body), 503, 'busy');
    assert.equal((await call(plan)).json.state, 'not-loaded');
    assertProblem(await call(`${plan}/render`, 'POST', { only_loaded: 1 }), 422, 'validation', '/only_loaded');
    await openPlan(url, 'phantom');
    assert.equal((await call(`${plan}/render`, 'POST', body)).status, 200);
  });

  test('is loaded by a job, and then tells what it holds', async () => {
    const job = await openPlan(url, 'phantom');
    assert.equal(job.state, 'done');
    assert.equal(job.percent, 100);
    const { json } = await call(plan);
    assert.equal(json.state, 'ready');
    assert.deepEqual(
      json.regions.map((r) => r.name),
      ['scalp', 'cranium', 'brain', 'target', 'tumour'],
    );
    assert.equal(json.regions.find((r) => r.name === 'brain').parent, 'cranium');
    // modified Snyder head: brain ellipsoid 6 x 9 x 6.5 cm, less the voxels that are target and tumour
    const inside = json.regions.filter((r) => ['brain', 'target', 'tumour'].includes(r.name)).reduce((sum, r) => sum + r.volume_cm3, 0);
    const ellipsoid = (4 / 3) * Math.PI * 6 * 9 * 6.5;
    assert.ok(Math.abs(inside / ellipsoid - 1) < 0.01, `${inside} cm3, expected ${ellipsoid}`);
    assert.equal(json.images[0].unit, 'HU');
    assert.deepEqual(json.doses[0].components.map((c) => c.quantity).sort(), ['boron', 'fast', 'gamma', 'nitrogen']);
    assert.equal((await call(`${api}/jobs/open-999`)).status, 404);
  });

  test('gives a picture as PNG and JPEG of the size asked for', async () => {
    const ask = (body) =>
      fetch(`${plan}/render`, { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(body) });
    const png = await ask({ view: { size_px: [320, 200] } });
    assert.equal(png.status, 200);
    assert.equal(png.headers.get('content-type'), 'image/png');
    const picture = readPng(await png.arrayBuffer());
    assert.deepEqual([picture.width, picture.height], [320, 200]);
    assert.match(png.headers.get('server-timing'), /render;dur=/);
    const jpeg = Buffer.from(await (await ask({ view: { size_px: [320, 200] }, format: 'jpeg', quality: 80 })).arrayBuffer());
    assert.equal(jpeg.readUInt16BE(0), 0xffd8);
  });

  test('is a pure function of plan, scene and view: the same request gives the same bytes', async () => {
    const ask = async () =>
      Buffer.from(
        await (
          await fetch(`${plan}/render`, {
            method: 'POST',
            headers: { 'Content-Type': 'application/json' },
            body: JSON.stringify({ view: { size_px: [200, 150] } }),
          })
        ).arrayBuffer(),
      );
    assert.ok((await ask()).equals(await ask()));
  });

  test("shows the tumour, which lies on the patient's left, on the right of a picture from the front and of an axial picture", async () => {
    const { regions } = (await call(plan)).json;
    const tumour = regions.find((r) => r.name === 'tumour');
    assert.ok(tumour.center_mm[0] > 10, 'the demo tumour is on the left: L > 0');
    const scene = {
      regions: Object.fromEntries(regions.map((r) => [r.id, { visible: r.id === tumour.id, opacity: 1, color: '#00ff00' }])),
      image: { slices: { axial: { visible: false } } },
    };
    const isGreen = ([r, g, b]) => g > 60 && g > 1.5 * r && g > 1.5 * b;
    const render = async (view) =>
      readPng(
        await (
          await fetch(`${plan}/render`, {
            method: 'POST',
            headers: { 'Content-Type': 'application/json' },
            body: JSON.stringify({ scene, view: { size_px: [300, 300], ...view } }),
          })
        ).arrayBuffer(),
      );
    const front = centreOf(await render({ kind: '3d' }), isGreen);
    assert.ok(front.n > 50, 'the tumour is seen');
    assert.ok(front.x > 160, `from the front the tumour is at x ${front.x} of 300`);
    const back = (await call(plan)).json.home['3d'];
    const behind = { ...back, position_mm: [back.target_mm[0], back.target_mm[1] + 700, back.target_mm[2]] };
    assert.ok(centreOf(await render({ kind: '3d', camera: behind }), isGreen).x < 140, 'from behind it is on the left');
  });

  test('refuses a wrong picture with the field that is wrong', async () => {
    const ask = (body, headers) => call(`${plan}/render`, 'POST', body, headers);
    assertProblem(await ask({ view: { size_px: [5, 200] } }), 422, 'validation', '/view/size_px/0');
    assertProblem(await ask({ scene: { regions: { liver: {} } } }), 422, 'validation', '/scene/regions/liver');
    assertProblem(await ask({ scene: { regions: { brain: { opacity: 2 } } } }), 422, 'validation', '/scene/regions/brain/opacity');
    assertProblem(await ask({ format: 'gif' }), 422, 'validation', '/format');
    assertProblem(await ask({ quality: 0 }), 422, 'validation', '/quality');
    assertProblem(await ask({ colour: 1 }), 422, 'validation', '/colour');
    assertProblem(await ask('{"view":'), 400, 'json');
    assertProblem(await ask('[]'), 422, 'validation');
    assertProblem(await ask('{}', { 'Content-Type': 'text/plain' }), 415, 'media-type');
    assertProblem(await ask(`{"view":{},"scene":{}}${' '.repeat(1 << 20)}`), 413, 'too-large');
    const home = (await call(plan)).json.home['3d'];
    const eyeInTarget = { ...home, position_mm: home.target_mm };
    assertProblem(await ask({ view: { camera: eyeInTarget } }), 422, 'validation');
  });

  test('gives the surface of a region, whose volume is that of its univels', async () => {
    const { json } = await call(`${plan}/regions/brain/surface?algorithm=marching-cubes`);
    assert.equal(json.algorithm, 'marching-cubes');
    assert.ok(json.triangles > 50000 && json.vertices > 25000);
    assert.ok(Math.abs(json.volume_mm3 / json.univel_volume_mm3 - 1) < 0.01, JSON.stringify(json));
    const cells = (await call(`${plan}/regions/brain/surface?algorithm=eight-cell`)).json;
    assert.equal(cells.algorithm, 'eight-cell');
    assert.equal(cells.univel_volume_mm3, json.univel_volume_mm3);
    assert.ok(
      cells.volume_mm3 < json.volume_mm3 && cells.triangles / json.triangles > 0.5 && cells.triangles / json.triangles < 0.85,
      JSON.stringify(cells),
    );
    const smooth = (await call(`${plan}/regions/brain/surface?algorithm=smooth`)).json;
    assert.equal(smooth.algorithm, 'smooth');
    assert.equal(smooth.triangles, json.triangles);
    assert.ok(
      Math.abs(smooth.volume_mm3 / json.univel_volume_mm3 - 1) < 0.0015 && smooth.area_mm2 < 0.95 * json.area_mm2,
      JSON.stringify(smooth),
    );
    assertProblem(await call(`${plan}/regions/liver/surface`), 404, 'not-found');
    assertProblem(await call(`${plan}/regions/brain/surface?algorithm=magic`), 422, 'validation', '/algorithm');
  });

  test('gives the figures of every way to show a region, and how fast it is drawn', async () => {
    const shape = async (query) => (await call(`${plan}/regions/tumour/surface?${query}`)).json;
    const univels = await shape('representation=univels&frames=3');
    assert.ok(Math.abs(univels.volume_mm3 - univels.univel_volume_mm3) < 1e-3 * univels.univel_volume_mm3);
    assert.ok(univels.distance_max_mm < 1e-3 && univels.draw_ms > 0, JSON.stringify(univels));
    assert.ok(Math.abs(univels.frames_per_second - 1000 / univels.draw_ms) < 1e-6 * univels.frames_per_second);
    for (const representation of ['points', 'solid']) {
      const points = await shape(`representation=${representation}`);
      assert.ok(
        points.points > 100 && points.triangles === 0 && points.area_mm2 === null && points.draw_ms === undefined,
        JSON.stringify(points),
      );
    }
    assert.ok((await shape('representation=outline')).lines > 3);
    const fan = await shape('representation=fan');
    assert.ok(fan.triangles > 100 && fan.volume_mm3 === null, 'overlapping triangles enclose nothing');
    const spline = await shape('representation=nurbs&order=3&bins=24');
    assert.deepEqual([spline.representation, spline.order, spline.sampling, spline.bins], ['nurbs', 3, 'traces', 24]);
    assert.ok(spline.distance_mean_mm < spline.distance_max_mm && spline.distance_max_mm < 10, JSON.stringify(spline));
    assertProblem(await call(`${plan}/regions/tumour/surface?representation=points&format=stl`), 422, 'validation', '/format');
    assertProblem(await call(`${plan}/regions/tumour/surface?representation=nurbs&order=9`), 422, 'validation', '/order');
  });

  test('gives the surface as a file whose size is that of its triangles, to be saved under the names of plan and region', async () => {
    const { json: facts } = await call(`${plan}/regions/tumour/surface`);
    const file = async (query) => {
      const answer = await fetch(`${plan}/regions/tumour/surface?${query}`);
      return {
        status: answer.status,
        type: answer.headers.get('content-type'),
        name: answer.headers.get('content-disposition'),
        bytes: Buffer.from(await answer.arrayBuffer()),
      };
    };
    const stl = await file('format=stl');
    assert.deepEqual([stl.status, stl.type, stl.name], [200, 'model/stl', 'attachment; filename="phantom-tumour.stl"']);
    assert.equal(stl.bytes.length, 84 + 50 * facts.triangles);
    assert.equal(stl.bytes.readUInt32LE(80), facts.triangles);
    const ply = await file('format=ply');
    assert.deepEqual([ply.status, ply.type, ply.name], [200, 'application/octet-stream', 'attachment; filename="phantom-tumour.ply"']);
    const head = ply.bytes.subarray(0, ply.bytes.indexOf('end_header\n') + 11).toString();
    assert.equal(ply.bytes.length, head.length + 24 * facts.vertices + 13 * facts.triangles);
    assert.match(head, /comment unit mm\n.*LPS.*\ncomment plan phantom\ncomment region tumour\n/);
    const glb = await file('format=glb');
    assert.deepEqual([glb.status, glb.type, glb.name], [200, 'model/gltf-binary', 'attachment; filename="phantom-tumour.glb"']);
    const jsonOf = ({ bytes }) => parseStrict(bytes.subarray(20, 20 + bytes.readUInt32LE(12)));
    const gltf = jsonOf(glb);
    assert.equal(gltf.asset.version, '2.0');
    assert.equal(gltf.accessors[gltf.meshes[0].primitives[0].attributes.POSITION].count, facts.vertices);
    assert.equal(gltf.accessors[gltf.meshes[0].primitives[0].indices].count, 3 * facts.triangles);
    assert.ok('NORMAL' in jsonOf(glb).meshes[0].primitives[0].attributes);
    assert.ok(!('NORMAL' in jsonOf(await file('format=glb&normals=face')).meshes[0].primitives[0].attributes));
    assertProblem(await call(`${plan}/regions/tumour/surface?format=obj`), 422, 'validation', '/format');
    const batch = await Promise.all(Array.from({ length: 16 }, () => call(`${plan}/regions/scalp/surface?format=stl`)));
    for (const answer of batch) if (answer.status !== 200) assertProblem(answer, 503, 'busy');
    assert.ok(batch.filter((answer) => answer.status === 200).length >= 4, 'four at once are made');
    assert.equal((await file('format=stl')).status, 200, 'and later ones again');
    const none = await call(`${plan}/regions/liver/surface?format=stl`);
    assertProblem(none, 404, 'not-found');
    assert.equal(none.headers.get('content-disposition'), null);
  });

  test('gives an oblique plane: square to the patient it is that slice, to the byte', async () => {
    const camera = { target_mm: [3, -4, 5], height_mm: 200 },
      size_px = [240, 180];
    const image = {
      slices: { coronal: { position_mm: 12.5 } },
      obliques: { mine: { origin_mm: [40, 12.5, -7], normal: [0, -3, 0] }, other: { origin_mm: [0, 0, 0], normal: [1, 1, 0] } },
    };
    const picture = async (view) => {
      const answer = await fetch(`${plan}/render`, {
        method: 'POST',
        headers: { 'Content-Type': 'application/json' },
        body: JSON.stringify({ scene: { image }, view: { size_px, camera, ...view } }),
      });
      assert.equal(answer.status, 200);
      return Buffer.from(await answer.arrayBuffer());
    };
    const slice = await picture({ kind: 'coronal' });
    assert.ok(slice.equals(await picture({ kind: 'oblique', plane: 'mine' })));
    assert.ok(!slice.equals(await picture({ kind: 'oblique', plane: 'other' })));
    assert.ok(
      (await picture({ kind: 'axial' })).equals(await picture({ kind: 'oblique', plane: 'gone' })),
      'a plane that is not there is the axial slice',
    );
  });

  test('tells how often values of an image are', async () => {
    const { images } = (await call(plan)).json;
    const image = `${plan}/images/${images[0].id}`,
      n = images[0].grid.size.reduce((product, side) => product * side);
    const whole = (await call(`${image}/histogram`)).json;
    assert.deepEqual([whole.image, whole.unit, whole.counts.length, whole.n + whole.n_left_out], [images[0].id, 'HU', 256, n]);
    assert.equal(
      whole.counts.reduce((sum, count) => sum + count),
      whole.n,
    );
    const percents = ['0.1', '1', '50', '99', '99.9'];
    assert.deepEqual(Object.keys(whole.percentiles).sort(), percents);
    const ascending = [whole.low, ...percents.map((percent) => whole.percentiles[percent]), whole.high];
    assert.deepEqual(
      ascending,
      [...ascending].sort((a, b) => a - b),
    );
    const halves = (await call(`${image}/histogram?bins=128`)).json.counts;
    assert.deepEqual(
      halves,
      halves.map((_, bin) => whole.counts[2 * bin] + whole.counts[2 * bin + 1]),
    );
    assertProblem(await call(`${image}/histogram?bins=0`), 422, 'validation', '/bins');
    assertProblem(await call(`${image}/histogram?bins=2.5`), 422, 'validation', '/bins');
    assertProblem(await call(`${plan}/images/none/histogram`), 404, 'not-found', '/image');
  });

  test('tells the mean of an image within an ellipse', async () => {
    const { regions, images } = (await call(plan)).json;
    const [x, y, z] = regions.find((r) => r.name === 'tumour').center_mm,
      ct = `${plan}/images/${images[0].id}`;
    const disc = (r) => `center=${x},${y},${z}&a=${x + r},${y},${z}&b=${x},${y + r},${z}`;
    const small = (await call(`${ct}/ellipse?${disc(4)}`)).json;
    assert.ok(Math.abs(small.area_mm2 - 16 * Math.PI) < 1e-9 && small.n_left_out === 0);
    assert.ok(Math.abs((small.n * small.step_mm ** 2) / small.area_mm2 - 1) < 0.2, `${small.n} samples`);
    assert.ok(small.min <= small.mean && small.mean <= small.max && small.sd >= 0 && small.sd <= (small.max - small.min) / 2);
    const { value } = (await call(`${plan}/probe?x=${x}&y=${y}&z=${z}`)).json.images[0];
    assert.ok(Math.abs(small.mean - value) < 60, `${small.mean} around ${value} HU`);
    const outside = (await call(`${ct}/ellipse?center=5000,0,0&a=5010,0,0&b=5000,10,0`)).json;
    assert.deepEqual([outside.n, outside.mean, outside.sd, outside.min, outside.max], [0, null, null, null, null]);
    assertProblem(await call(`${ct}/ellipse?center=1,2,3&a=2,2,3&b=5,2,3`), 422, 'validation', '/b');
    assertProblem(await call(`${ct}/ellipse?center=1,2,3&a=2,2,3`), 422, 'validation', '/b');
    for (const bad of ['1,2', '1,2,3,4', '1,2,nan', '0x1,2,3', '1,2,1e9', ' 1,2,3', '1;2;3'])
      assertProblem(await call(`${ct}/ellipse?center=${encodeURIComponent(bad)}&a=2,2,3&b=5,9,3`), 422, 'validation', '/center');
    assertProblem(await call(`${plan}/images/none/ellipse?${disc(4)}`), 404, 'not-found', '/image');
  });

  test('tells what lies at a point and under a pixel', async () => {
    const { regions, home } = (await call(plan)).json;
    const [x, y, z] = regions.find((r) => r.name === 'tumour').center_mm;
    const probe = (await call(`${plan}/probe?x=${x}&y=${y}&z=${z}`)).json;
    assert.equal(probe.regions[0], 'tumour');
    assert.equal(probe.images[0].unit, 'HU');
    assert.ok(Math.abs(probe.images[0].value - 48) < 40, `tumour at ${probe.images[0].value} HU`);
    assert.equal(probe.doses.length, 4);
    for (const dose of probe.doses) assert.ok(dose.value > 0 && dose.unit === 'Gy' && dose.per, JSON.stringify(dose));
    const outside = (await call(`${plan}/probe?x=5000&y=0&z=0`)).json;
    assert.deepEqual([outside.regions, outside.images, outside.doses], [[], [], []]);
    assertProblem(await call(`${plan}/probe?x=1&y=2`), 422, 'validation', '/z');
    assertProblem(await call(`${plan}/probe?x=1&y=2&z=nan`), 422, 'validation', '/z');
    const view = encodeURIComponent(JSON.stringify({ size_px: [400, 400], camera: home['3d'] }));
    const { hits } = (await call(`${plan}/pick?view=${view}&px=200&py=200`)).json;
    assert.equal(hits[0].region, 'scalp', 'the scalp is in front');
    for (let i = 1; i < hits.length; i++) assert.ok(hits[i].distance_mm >= hits[i - 1].distance_mm);
    assert.ok(hits[0].point_lps_mm[1] < 0, 'the home camera looks from the front: the first hit is anterior');
    assert.equal(hits.filter(({ seen }) => seen).length, 1);
    for (const { alpha } of hits) assert.ok(alpha > 0 && alpha <= 1);
    const { hits: skin } = (await call(`${plan}/pick?view=${view}&px=200&py=200&prefer=scalp`)).json;
    assert.deepEqual(
      skin.map(({ seen }) => seen),
      hits.map((_, at) => at === 0),
      'nothing is before the scalp',
    );
    assert.deepEqual(
      hits.map(({ beam, draft }) => [beam, draft]),
      hits.map(() => [null, false]),
      'no beam is drawn',
    );
    const {
      beams: [beam],
    } = (await call(plan)).json;
    const above = {
      size_px: [400, 400],
      camera: {
        position_mm: [0, -600, 0],
        target_mm: [beam.entry_mm[0], beam.entry_mm[1], beam.entry_mm[2] + 10],
        projection: 'parallel',
        height_mm: 100,
      },
    };
    for (const [overlaid, expected] of [
      [{ looks: { [beam.id]: { visible: true } } }, [beam.id, false]],
      [{ draft: { enabled: true, line: { entry_mm: beam.entry_mm, target_mm: beam.target_mm } } }, [beam.id, true]],
    ]) {
      const drawn = encodeURIComponent(JSON.stringify({ ...above, override: { beam: overlaid } }));
      const { hits: lines } = (await call(`${plan}/pick?view=${drawn}&px=202&py=200`)).json;
      assert.equal(lines[0].region, null);
      assert.ok(
        lines.some(({ beam: id, draft }) => id === expected[0] && draft === expected[1]),
        JSON.stringify(lines),
      );
    }
    assertProblem(await call(`${plan}/pick?view=${view}&px=200&py=200&prefer=liver`), 404, 'not-found', '/prefer');
    assertProblem(await call(`${plan}/pick?view=${view}&px=200`), 422, 'validation', '/py');
  });

  test('is drawn for many at once', async () => {
    const answers = await Promise.all(
      Array.from({ length: 24 }, (_, i) => call(`${plan}/render`, 'POST', { view: { size_px: [64 + i, 48] }, format: 'jpeg' })),
    );
    assert.deepEqual(
      answers.map((a) => a.status),
      Array(24).fill(200),
    );
  });
});

describe('a room', () => {
  let room;
  before(async () => {
    await openPlan(url, 'phantom');
    const made = await call(`${api}/rooms`, 'POST', { plan: 'phantom' });
    assert.equal(made.status, 201, made.text);
    assert.equal(made.headers.get('location'), `/api/v1/rooms/${made.json.id}`);
    room = `${api}/rooms/${made.json.id}`;
    await until(
      () => call(`${room}/scene`),
      (a) => a.status === 200,
    );
  });

  test('is made on a plan that exists, listed and told', async () => {
    assertProblem(await call(`${api}/rooms`, 'POST', { plan: 'nowhere' }), 404, 'not-found');
    assertProblem(await call(`${api}/rooms`, 'POST', { plan: 'broken' }), 409, 'plan-unreadable');
    assertProblem(await call(`${api}/rooms`, 'POST', {}), 422, 'validation', '/plan');
    assertProblem(await call(`${api}/rooms`, 'POST', { plan: 'phantom', name: 1 }), 422, 'validation', '/name');
    assert.equal((await call(room)).json.plan, 'phantom');
    assert.ok((await call(`${api}/rooms`)).json.rooms.some((r) => room.endsWith(r.id)));
    assert.deepEqual((await call(`${room}/members`)).json.members, []);
  });

  test('changes its scene only for who names the revision it changed', async () => {
    const first = await call(`${room}/scene`);
    const etag = first.headers.get('etag');
    assert.match(etag, /^"\d+"$/);
    assert.equal((await call(`${room}/scene`, 'GET', undefined, { 'If-None-Match': etag })).status, 304);
    const patch = { regions: { scalp: { opacity: 0.2 } } };
    assertProblem(await call(`${room}/scene`, 'PATCH', patch), 428, 'revision-needed');
    assertProblem(await call(`${room}/scene`, 'PATCH', patch, { 'If-Match': '"999999"' }), 412, 'stale-revision');
    assertProblem(await call(`${room}/scene`, 'PATCH', patch, { 'If-Match': `W/${etag}` }), 412, 'stale-revision');
    assert.deepEqual((await call(`${room}/scene`)).json, first.json, 'nothing was applied');
    const changed = await call(`${room}/scene`, 'PATCH', patch, { 'If-Match': etag, 'Content-Type': 'application/merge-patch+json' });
    assert.equal(changed.status, 200, changed.text);
    assert.equal(changed.json.regions.scalp.opacity, 0.2);
    assert.notEqual(changed.headers.get('etag'), etag);
    assertProblem(await call(`${room}/scene`, 'PATCH', patch, { 'If-Match': etag }), 412, 'stale-revision');
    const back = await call(`${room}/scene`, 'PATCH', { regions: { scalp: null } }, { 'If-Match': '*' });
    assert.deepEqual(back.json, first.json, "null gives the plan's own value back");
  });

  test('lets exactly one of many who changed the same revision win', async () => {
    const etag = (await call(`${room}/scene`)).headers.get('etag');
    const answers = await Promise.all(
      Array.from({ length: 10 }, (_, i) => call(`${room}/scene`, 'PATCH', { image: { window: { center: i } } }, { 'If-Match': etag })),
    );
    assert.deepEqual(answers.map((a) => a.status).sort(), [200, ...Array(9).fill(412)]);
  });

  test('applies a patch whole or not at all', async () => {
    const first = await call(`${room}/scene`);
    const answer = await call(
      `${room}/scene`,
      'PATCH',
      { surface: { normals: 'face' }, regions: { brain: { opacity: 7 } } },
      { 'If-Match': '*' },
    );
    assertProblem(answer, 422, 'validation', '/regions/brain/opacity');
    assert.deepEqual((await call(`${room}/scene`)).json, first.json);
  });

  test('shows what was changed in its snapshot', async () => {
    const snapshot = async (query = '') =>
      Buffer.from(await (await fetch(`${room}/snapshot?view=${encodeURIComponent('{"size_px":[160,120]}')}${query}`)).arrayBuffer());
    const one = await snapshot();
    assert.equal(readPng(one).width, 160);
    await call(`${room}/scene`, 'PATCH', { regions: { scalp: { visible: false } } }, { 'If-Match': '*' });
    assert.ok(!one.equals(await snapshot()));
    assert.equal((await snapshot('&format=jpeg&quality=50')).readUInt16BE(0), 0xffd8);
    assertProblem(await call(`${room}/snapshot?view=${encodeURIComponent('{"kind":"sideways"}')}`), 422, 'validation', '/view/kind');
    assertProblem(await call(`${room}/snapshot?view=nojson`), 400, 'json');
  });

  test('says with its snapshot which revision was drawn: the one its scene has as ETag', async () => {
    const snapshot = async () => {
      const answer = await fetch(`${room}/snapshot?view=${encodeURIComponent('{"size_px":[32,32]}')}`);
      await answer.arrayBuffer();
      return [answer.status, answer.headers.get('beamroom-revision')];
    };
    const etag = async () => JSON.parse((await call(`${room}/scene`)).headers.get('etag'));
    const before = await etag();
    assert.deepEqual(await snapshot(), [200, before]);
    await call(`${room}/scene`, 'PATCH', { regions: { brain: { opacity: 0.31 } } }, { 'If-Match': '*' });
    assert.equal(await etag(), String(Number(before) + 1));
    assert.deepEqual(await snapshot(), [200, await etag()]);
    const picture = await fetch(`${plan}/render`, {
      method: 'POST',
      headers: { 'Content-Type': 'application/json' },
      body: '{"view":{"size_px":[32,32]}}',
    });
    await picture.arrayBuffer();
    assert.equal(picture.headers.get('beamroom-revision'), null, 'a picture without a room has no revision');
  });

  test('is gone when it has been closed', async () => {
    assert.equal((await call(room, 'DELETE')).status, 204);
    assertProblem(await call(room), 404, 'not-found');
    assertProblem(await call(`${room}/scene`), 404, 'not-found');
  });
});
