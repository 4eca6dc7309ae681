// The main states of the room page at the sizes it is made for, for tests that hold in all of them.

export const sizes = {
  wide: { viewport: { width: 1600, height: 1000 } },
  compact: { viewport: { width: 1280, height: 720 } },
  tablet: { viewport: { width: 1180, height: 820 }, hasTouch: true, isMobile: true },
  phone: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true },
};

const region = (page) => page.locator('[data-region]').last().locator('button.name').click();
const tab = (name) => [`tab ${name}`, (page) => page.getByRole('tab', { name, exact: true }).click()];
const popovers = [
  ['invitation', (page) => page.locator('[aria-label="Invite"]').click()],
  ['help', (page) => page.locator('[aria-label="Help"]').click()],
  ['nothing open', (page) => page.keyboard.press('Escape')],
];
const maximised = [
  ['maximised', (page) => page.locator('[aria-label="Maximise Axial"]').click()],
  ['restored', (page) => page.locator('[aria-label="Restore Axial"]').click()],
];
const popover = (page, selector) => page.locator(selector).click();
const views = [
  ['camera of 3-D', (page) => popover(page, '[data-view="1"] .view-all')],
  ['what a pane shows', (page) => popover(page, '[data-view="2"] .view-kind button')],
  ['oblique in a pane', (page) => page.getByRole('menuitemradio', { name: 'Oblique' }).click()],
  ['what an oblique pane shows', (page) => popover(page, '[data-view="5"] .view-kind button')],
  ['axial again', (page) => page.getByRole('menuitemradio', { name: 'Axial' }).click()],
];
const layouts = [
  ['menu of the panes', (page) => popover(page, 'button[aria-label="Panes"]')],
  ['two panes', (page) => page.getByRole('radio', { name: 'Two panes' }).click()],
  [
    'oblique beside 3-D',
    async (page) => {
      await popover(page, 'button[aria-label="Panes"]');
      await page.getByRole('radio', { name: '3-D and oblique' }).click();
    },
  ],
  [
    'four panes again',
    async (page) => {
      await popover(page, 'button[aria-label="Panes"]');
      await page.getByRole('radio', { name: 'Four panes' }).click();
    },
  ],
];
const dock = (name) => [`sheet ${name}`, (page) => page.locator('.dock button', { hasText: name }).click()];
const parts = ['Images', 'Planes', 'Regions', 'Doses', 'Beams', 'Tracks', 'Saved views', 'Clip'];
const planes = [
  ['a new plane', (page) => page.locator('[data-key="oblique:"] button.name').click()],
  ['an oblique plane', (page) => page.locator('.clip-angles button').click()],
  ['points of a plane', (page) => page.locator('#tab-panel button', { hasText: 'Three points' }).click()],
  ['no points', (page) => page.locator('#tab-panel button', { hasText: 'Cancel' }).click()],
];
const clip = [
  [
    'clip planes that cut',
    async (page) => {
      for (const id of ['sagittal_high', 'free', 'axial_high']) await page.locator(`[data-key="clip:${id}"] .eye`).click();
    },
  ],
  ['a clip plane', (page) => page.locator('[data-key="clip:axial_high"] button.name').click()],
];
const free = ['the free clip plane', (page) => page.locator('[data-key="clip:free"] button.name').click()];

/** For each size, what leads from one state to the next: [name, act]. For a plan that has every part. @type {Record<string, [string, (page) => Promise<void>][]>} */
export const states = {
  wide: [
    ['at first', async () => {}],
    ['a region', region],
    ...['dose', 'image', 'beam', 'tracks'].map((kind) => [
      `a ${kind}`,
      (page) => page.locator(`[data-key^="${kind}:"] button.name`).first().click(),
    ]),
    ['section Clip', (page) => page.locator('[data-key="section:clip"]').click()],
    ...clip,
    free,
    ['section Planes', (page) => page.locator('[data-key="section:planes"]').click()],
    ...planes,
    ['the 3-D picture', (page) => page.locator('button[aria-label="3-D picture"]').click()],
    tab('Probe'),
    tab('Plan'),
    ...popovers,
    ...maximised,
    ...['Three panes in a row', 'One large, three small', 'Four panes'].map((name) => [
      name,
      (page) => page.locator(`[aria-label="${name}"]`).click(),
    ]),
    ...views,
    ...layouts,
    ['tree folded', (page) => page.locator('[aria-label="Fold the plan\'s parts"]').click()],
    ['inspector folded', (page) => page.locator('[aria-label="Fold the inspector"]').click()],
  ],
  compact: [
    ['at first', async () => {}],
    ...['images', 'regions', 'doses', 'beams', 'tracks', 'saved'].map((id) => [
      `section ${id}`,
      (page) => page.locator(`[data-section="${id}"]`).click(),
    ]),
    ['section clip', (page) => page.locator('[data-section="clip"]').click()],
    ...clip,
    ['section planes', (page) => page.locator('[data-section="planes"]').click()],
    ...planes,
    [
      'section pinned',
      async (page) => {
        await page.locator('[data-section="regions"]').click();
        await page.locator('[aria-label="Pin"]').click();
      },
    ],
    ['a region', region],
    tab('Probe'),
    tab('Plan'),
    ...popovers,
    ...maximised,
    ['section closed', (page) => page.locator('[aria-label="Close Regions"]').click()],
    ...views,
    ...layouts,
    ['inspector folded', (page) => page.locator('[aria-label="Fold the inspector"]').click()],
  ],
  tablet: [
    ['at first', async () => {}],
    dock('Probe'),
    tab('Plan'),
    tab('Selection'),
    dock('Parts'),
    ...parts.map((name) => tab(name)),
    ...clip,
    dock('Parts'),
    tab('Planes'),
    ...planes,
    dock('Parts'),
    tab('Regions'),
    ['a region', region],
    ...popovers,
    ['sheet closed', (page) => page.locator('[aria-label="Close the sheet"]').click()],
    ...maximised,
    ...views,
    ...layouts,
  ],
  phone: [
    ['at first', async () => {}],
    ...views.slice(0, 1),
    ['nothing open', (page) => page.keyboard.press('Escape')],
    ...['Axial', 'Sagittal', 'Coronal', '3-D'].map((name) => [
      `pane ${name}`,
      (page) => page.locator('[aria-label="Pane"] button', { hasText: name }).click(),
    ]),
    dock('Probe'),
    tab('Plan'),
    tab('Selection'),
    dock('Parts'),
    ...parts.map((name) => tab(name)),
    ...clip,
    dock('Parts'),
    tab('Planes'),
    ...planes,
    dock('Parts'),
    tab('Regions'),
    ['a region', region],
    ...popovers,
  ],
};
