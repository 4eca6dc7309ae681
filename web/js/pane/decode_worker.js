// Decodes pictures for decoder.js, which says why.
addEventListener('message', async ({ data: { id, picture, type } }) => {
  try {
    const bitmap = await createImageBitmap(new Blob([picture], { type }));
    postMessage({ id, bitmap }, [bitmap]);
  } catch {
    postMessage({ id, bitmap: null });
  }
});
postMessage({ isReady: true });
