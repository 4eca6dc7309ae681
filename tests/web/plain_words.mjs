// Words on the page that only a program understands: names of fields, codes. Names of a plan's parts and terms of the field are none.

/** Terms and signs of the field, of files and of units; what a person reads in a textbook, a file's name or a treatment planning system. */
const terms = `
  BPA BSH RBE CBE BNCT DVH PET SPECT MRI SUV GTV CTV PTV OAR ICRU IEC LPS RAS RTSTRUCT RTPLAN RTDOSE NURBS HFS HFP FFS FFP RTOG AAPM
  DICOM SERA NIfTI NRRD PACS JPEG PNG PDF CSV STL PLY GLB glTF JSON HTTP HTTPS API ZIP SHA UTC URL RMS ROI CPU GPU OpenGL MCNP PHITS Geant4
  cGy mGy kGy cGy(w) keV MeV kHz MHz dB mL MiB GiB kB WebM MP4 Sera3d Otsu CIEDE2000 PHANTOM README AVX2
`
  .trim()
  .split(/\s+/);

/**
 * Every visible text, name of a control and tooltip with a word that looks like a field or a code.
 * @param {import('playwright-core').Page} page @param {string[]} names of the plan's parts and people, which are as they are
 * @returns {Promise<string[]>} each word, and where it stands
 */
export const codesOn = (page, names = []) =>
  page.evaluate(
    ([known, own]) => {
      const isMetric = (word) => /^[DV]\d+(cc|Gy)?$/.test(word); // D95, V20
      const isCode = (word) => /[A-Za-z0-9]_[A-Za-z0-9]/.test(word) || /^[a-z]+[A-Z]/.test(word) || /^[A-Z][A-Z0-9]{2,}$/.test(word);
      const found = new Set();
      const look = (text, where) => {
        let rest = text;
        for (const name of own) rest = rest.replaceAll(name, ' ');
        for (const word of rest.split(/[^\p{L}\p{N}_()]+/u))
          if (isCode(word) && !known.includes(word) && !known.includes(word.replace(/[()]/g, '')) && !isMetric(word))
            found.add(`${word}: ${where}: "${text.trim().slice(0, 80)}"`);
      };
      const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
      while (walker.nextNode()) {
        const { parentElement: element, data } = walker.currentNode;
        // keys, addresses, hashes, and what stands in a file are quoted as they are
        if (!data.trim() || element.closest('script, style, noscript, kbd, code, pre, .hash, [translate="no"]')) continue;
        if (element.checkVisibility({ opacityProperty: true, visibilityProperty: true }))
          look(data, element.closest('[class]')?.className || element.localName);
      }
      for (const name of ['aria-label', 'title', 'placeholder', 'aria-valuetext'])
        for (const element of document.querySelectorAll(`[${name}]`))
          if (element.checkVisibility({ visibilityProperty: true }))
            look(element.getAttribute(name), `${name} of ${element.className || element.localName}`);
      return [...found];
    },
    [terms, names],
  );
